//! Numbers for light transport: counter-based random numbers and elementary functions that give the
//! same bits on every machine. Knows no rendering.
