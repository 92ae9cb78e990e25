//! Placeholder, replaced by the io branch.
/// Warning.
#[derive(Clone, Debug)]
pub struct Warning;
