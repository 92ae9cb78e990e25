//! What the filters are held against, on the CPU: the NDF's own picture.

pub mod ndf_density;
