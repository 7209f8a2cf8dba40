//! How light moves: the reference path tracer of the volume rendering equation and the fast engine.
