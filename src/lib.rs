//! What happens to a normal map when it is filtered.

pub mod image_io;
pub mod normal_map;
