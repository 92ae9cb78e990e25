//! Meshes from files: what is wrong with them is said in one sentence, what is right is drawn without a seam.

pub mod files;
mod refused;
mod seams;
