//! Who follows a measurement, and what is told.

use super::figures::{MethodFigures, Reference};
use crate::color::srgb8_from_linear;
use crate::filter::MethodChoice;
use crate::gpu::readback::ReadbackError;
use crate::reference::Picture;
use crate::session::Session;

/// Something was found.
#[derive(Clone, Debug)]
pub enum Finding {
    /// The truth of a point's view.
    Truth {
        /// Which point.
        point: usize,
        /// What it is worth.
        reference: Reference,
        /// Its picture, where pictures are wanted.
        picture: Option<Shown>,
    },
    /// A method at a point; the point's truth came before.
    Method {
        /// Which point.
        point: usize,
        /// Which of the methods.
        method: usize,
        /// What it is off the truth.
        figures: MethodFigures,
        /// Its picture, where pictures are wanted.
        picture: Option<Shown>,
    },
}

/// A picture as it is displayed.
#[derive(Clone, Debug)]
pub struct Shown {
    /// Pixels across and down.
    pub size: [u32; 2],
    /// sRGB, row by row from the top.
    pub rgb: Vec<u8>,
}

impl Shown {
    /// A linear picture, encoded.
    pub fn new(picture: &Picture) -> Self {
        let rgb = picture.rgb.iter().flat_map(|&color| srgb8_from_linear(color)).collect();
        Self { size: picture.size, rgb }
    }
}

/// Follows a measurement.
pub trait Follower {
    /// A method is taken up at a point.
    fn begins(&mut self, method: MethodChoice, point: usize);

    /// The session fits or builds what the method needs; called twenty times a second.
    fn waits(&mut self, session: &Session) {
        let _ = session;
    }

    /// Something was found.
    fn finds(&mut self, finding: Finding);

    /// True once nobody wants the rest.
    fn is_cancelled(&self) -> bool {
        false
    }
}

/// Why a measurement ended early.
#[derive(Debug, thiserror::Error)]
pub enum MeasureError {
    /// Nobody wants the rest.
    #[error("the measurement was cancelled")]
    Cancelled,
    /// The fit or the channels of a method failed.
    #[error("{0}")]
    Session(String),
    /// A picture did not come about.
    #[error("{0} was not drawn.")]
    NotDrawn(String),
    /// A picture could not be read.
    #[error(transparent)]
    Readback(#[from] ReadbackError),
}
