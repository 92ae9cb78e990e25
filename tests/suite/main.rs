//! One binary for all integration tests, since linking is slow; a module for each law or face.

mod opening;
