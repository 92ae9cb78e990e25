//! Opening files and writing them: what is kept, what is refused and in which words.

pub mod files;
mod refused;
mod round_trips;
mod written;
