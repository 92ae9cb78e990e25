//! One binary for all laws and faces, for wgpu links slowly: a module per law or face.

mod alignment;
mod cli;
mod color;
mod compare;
mod doctor;
mod exports;
mod fit;
mod gpu;
mod house;
mod lobes_exr;
mod materials;
mod measured;
mod meshes;
mod objectives;
mod opening;
mod probe;
mod refit;
mod rivals;
mod selection;
mod window;
