//! Opening files and writing them: what is kept, what is refused and in which words.

#![expect(clippy::unwrap_used, reason = "a test that cannot make its files has failed")]

pub mod files;
mod refused;
mod round_trips;
mod written;
