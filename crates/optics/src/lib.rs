//! Phase functions and coefficients of participating media. Knows no geometry.
