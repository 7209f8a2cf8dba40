//! Samples become an image with its error.
