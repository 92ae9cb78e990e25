//! One binary for all laws and faces, for wgpu links slowly: a module per law or face.

mod alignment;
mod cli;
mod fit;
mod gpu;
mod house;
mod opening;
mod window;
