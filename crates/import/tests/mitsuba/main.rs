//! Mitsuba scenes become the descriptions that mean the same.

mod bench;
mod cameras;
mod damage;
mod files;
mod grids;
mod lights;
mod materials;
mod media;
mod shapes;
mod support;
