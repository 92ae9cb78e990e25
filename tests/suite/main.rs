//! The tests that need more than one module: a file per law or face.

mod gpu;
