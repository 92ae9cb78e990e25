//! What happens to a normal map when it is filtered.
//!
//! Averaging normals is wrong, because shading is not linear in the normal. The shading of a texel is the convolution
//! of the BRDF with the texel's *normal distribution function*, the set of base-level normals under it (Han, Sun,
//! Ramamoorthi and Grinspun 2007). This crate keeps an NDF as a mixture of von Mises-Fisher lobes, fits them for every
//! texel of every MIP level, aligns them so that hardware may interpolate them, and shows what they do beside the
//! truth.
//!
//! # The way through
//! ```text
//! file -> image_io -> normal_map: decode, diagnose, height -> pyramid: footprints -> ndf of any texel
//!                                                               |
//!                            jobs (thread, cancel)  ->  filter: truth, rivals, vmf (seed, em, align)
//!                                                               v
//!             session (what is open, chosen and fitted; revision) -> reference (CPU pictures, error figures)
//!                                                               v  values only
//!     gpu frame: environment -> surface -> compare; sphere -> app/viewport (in the window) or readback (without one)
//! ```
//!
//! # Layers
//! A module uses only its own layer and lower ones; a test holds this.
//!
//! | layer | modules | what |
//! | --- | --- | --- |
//! | 0 | [`sphere`], [`color`] | mathematics on the unit sphere |
//! | 1 | [`image_io`], [`normal_map`], [`scene`] | what is loaded and looked at |
//! | 2 | [`ndf`], [`brdf`], [`lighting`] | what a texel holds, what it reflects |
//! | 3 | [`filter`], [`lit_surface`], [`comparison`] | every filtering method behind one trait; what the surface's picture depends on; which methods are seen beside each other |
//! | 4 | [`reference`](mod@reference), [`export`], [`gpu`] | pictures and figures on the processor; files; pictures on the GPU |
//! | 5 | [`jobs`], [`session`], [`measure`] | the only threads; the one document; methods held against the truth |
//! | 6 | [`app`], [`headless`], [`cli`] | faces |
//!
//! # Words
//! - **texel**: an element of a MIP level; its **footprint** is the box of base texels it covers.
//! - **NDF**: the footprint's unit normals, weighted by area.
//! - **lobe**: a von Mises-Fisher density of weight alpha, mean direction mu and concentration kappa, stored as
//!   `(alpha, alpha A(kappa) mu)`; a **slot** is its place in the storage, a **mixture** all lobes of a texel.
//! - **filter**, or method: a way to estimate a texel's effective BRDF; the **truth** is the sum over the footprint, a
//!   **rival** any method beside the truth and the lobes, its **channels** the numbers that it keeps per texel.
//! - **tangent space**: `+x` right, `+y` up the image, `+z` out of it.

pub mod app;
pub mod brdf;
pub mod cli;
pub mod color;
pub mod comparison;
pub mod export;
pub mod filter;
pub mod gpu;
pub mod headless;
pub mod image_io;
pub mod jobs;
pub mod lighting;
pub mod lit_surface;
pub mod measure;
pub mod ndf;
pub mod normal_map;
pub mod reference;
pub mod scene;
pub mod session;
pub mod sphere;
