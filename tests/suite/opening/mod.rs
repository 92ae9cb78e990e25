//! Opening files and writing them: what is kept, what is refused and in which words.

mod files;
mod refused;
mod round_trips;
mod written;
