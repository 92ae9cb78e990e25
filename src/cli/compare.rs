//! `compare`: every method against the truth, as a table and as pictures.
//!
//! A cell is one map from one distance with one exponent; of several, the means are given too.

mod bar;
pub mod maps;
pub mod sheet;
pub mod table;

use std::path::{Path, PathBuf};

use clap::Args;

use super::brdf::{Analytic, BrdfArgument};
use super::look::LookArguments;
use super::options::{FitArguments, MapArguments, write_text};
use super::render::{PICTURE_SAMPLES, PictureSize};
use super::start::Start;
use crate::brdf::Brdf;
use crate::filter::{MethodChoice, Rival};
use crate::gpu::Gpu;
use crate::headless::Screenshot;
use crate::image_io::write_png_rgba8;
use crate::lit_surface::LitSurface;
use crate::measure::{Cell, MeasureSettings, Measurer, Point, files};
use crate::scene::Camera;
use crate::session::Session;
use bar::Bar;
use sheet::Row;

/// Every method against the truth: a table, and pictures.
#[derive(Args, Debug)]
pub struct CompareCommand {
    /// Normal maps, bundled ones by name, and folders of images; without any the session's map, or the bundled sample.
    #[arg(value_name = "MAP")]
    pub maps: Vec<PathBuf>,
    /// How the maps are read.
    #[command(flatten)]
    pub map_arguments: MapArguments,
    /// How they are fitted, once for all cells.
    #[command(flatten)]
    pub fit: FitArguments,
    /// A session file to start from.
    #[arg(long, value_name = "FILE")]
    pub session: Option<PathBuf>,
    /// The methods, with commas between: truth, mip, mip-unnormalised, toksvig, lean, gmm:N, sh:LMAX, vmf:J or
    /// vmf:J:unaligned; vmf and vmf:unaligned are of as many lobes as --lobes says.
    #[arg(
        long,
        value_name = "LIST",
        value_delimiter = ',',
        default_value = "mip,mip-unnormalised,toksvig,lean,gmm:4,sh:7,vmf,vmf:unaligned"
    )]
    pub methods: Vec<MethodChoice>,
    /// Distances from the eye to the surface's centre, with commas between.
    #[arg(long, value_name = "LIST", value_delimiter = ',', value_parser = parse_distance)]
    pub distances: Vec<f32>,
    /// Exponents of a Blinn-Phong material, with commas between; of every model that --models names the material as
    /// wide.
    #[arg(long, value_name = "LIST", value_delimiter = ',', value_parser = parse_exponent, conflicts_with = "brdf")]
    pub exponents: Vec<f32>,
    /// The models that take the widths of --exponents, with commas between.
    #[arg(long, value_name = "LIST", value_enum, value_delimiter = ',', requires = "exponents")]
    pub models: Vec<Analytic>,
    /// Materials beside those, with commas between: blinn-phong:S, torrance-sparrow:SIGMA, ggx:ALPHA or merl:FILE.
    #[arg(long, value_name = "LIST", value_delimiter = ',', conflicts_with = "brdf")]
    pub brdfs: Vec<BrdfArgument>,
    /// Measure the mean change from frame to frame too, each method's beside the truth's, over a dolly of N frames:
    /// the first at the cell's distance, each of the others 1/16 farther than the one before.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(2..=256))]
    pub dolly: Option<u16>,
    /// The surface and its material.
    #[command(flatten)]
    pub look: LookArguments,
    /// Pixels across and down of each picture.
    #[arg(long, value_name = "WxH", default_value = "480x300")]
    pub size: PictureSize,
    /// Samples per pixel of the truth that the methods are held against; 1024, or the session's if those are more.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(2..=65536))]
    pub samples: Option<u32>,
    /// Write the figures as JSON to FILE, - for standard output: `cells` has those of each map, distance and exponent;
    /// `reference` and `methods` are their means over all cells.
    #[arg(long, value_name = "FILE")]
    pub json: Option<PathBuf>,
    /// Write the figures as comma-separated values to FILE, - for standard output.
    #[arg(long, value_name = "FILE")]
    pub csv: Option<PathBuf>,
    /// Write a contact sheet as PNG to FILE, - for standard output: a block for each cell, the truth first, each picture
    /// with its method and colour error.
    #[arg(long, value_name = "FILE")]
    pub sheet: Option<PathBuf>,
}

/// Frames whose median time is reported.
const TIMED_FRAMES: usize = 5;

fn parse_distance(text: &str) -> Result<f32, String> {
    let range = Camera::MIN_DISTANCE..=Camera::MAX_DISTANCE;
    let distance = text.parse().ok().filter(|distance| range.contains(distance));
    distance.ok_or_else(|| format!("write distances from {} to {}", Camera::MIN_DISTANCE, Camera::MAX_DISTANCE))
}

fn parse_exponent(text: &str) -> Result<f32, String> {
    let exponent = text.parse().ok().filter(|exponent| (1.0..=1e5).contains(exponent));
    exponent.ok_or_else(|| "write exponents from 1 to 100000".to_owned())
}

impl CompareCommand {
    /// Carries the command out.
    ///
    /// # Errors
    /// One sentence that names the file and the cause.
    pub fn run(self) -> anyhow::Result<()> {
        for MethodChoice { method, .. } in &self.methods {
            let is_drawn = method.rival().is_none_or(Rival::is_drawn);
            anyhow::ensure!(is_drawn, "{method} is too much for a picture; probe takes it.");
        }
        let maps = maps::every_map(&self.maps)?;
        // What is wrong with the first map, the only one as a rule, is told before anything is set up.
        let first = self.session_of(maps[0].as_deref())?;
        let gpu = Gpu::headless()?;
        let rows = self.measure(&gpu, &maps, first)?;
        if let Some(path) = &self.sheet {
            let Screenshot { size, rgba } = sheet::draw(&gpu, &rows)?;
            write_png_rgba8(path, size[0] as usize, size[1] as usize, &rgba)?;
        }
        let cells: Vec<Cell> = rows.into_iter().map(|row| row.cell).collect();
        if let Some(path) = &self.json {
            let json = files::json(&cells).ok_or_else(|| anyhow::anyhow!("Nothing was compared."))?;
            write_text(path, &json?)?;
        }
        if let Some(path) = &self.csv {
            write_text(path, files::csv(&cells).trim_end())?;
        }
        let uses_output = [&self.json, &self.csv, &self.sheet].into_iter().flatten().any(|path| path == Path::new("-"));
        if uses_output { Ok(()) } else { write_text("-".as_ref(), table::text(&cells).trim_end()) }
    }

    /// Every cell of every map, of which `first` is the first one's session.
    fn measure(&self, gpu: &Gpu, maps: &[Option<PathBuf>], first: Session) -> anyhow::Result<Vec<Row>> {
        let settings = self.settings(&first);
        let brdfs = self.every_brdf()?;
        let mut bar = Bar::new(maps.len() * self.distances.len().max(1) * brdfs.len().max(1), &settings);
        let mut measurer = Measurer::new(gpu, &settings);
        let mut rows = Vec::new();
        let mut first = Some(first);
        for path in maps {
            let mut session = first.take().map_or_else(|| self.session_of(path.as_deref()), Ok)?;
            let map = path.as_ref().map_or_else(|| session.map().name(), |path| path.display().to_string());
            let points = self.points(&session, &brdfs);
            bar.map(&map, points.len());
            measurer.measure(&mut session, &points, &mut bar)?;
            rows.extend(bar.rows(&points));
        }
        bar.finish();
        Ok(rows)
    }

    fn settings(&self, first: &Session) -> MeasureSettings {
        let PictureSize(size) = self.size;
        MeasureSettings {
            methods: self.methods.clone(),
            size,
            truth_samples: first.truth_samples,
            timed_frames: TIMED_FRAMES,
            dolly_frames: self.dolly.map_or(0, usize::from),
            keeps_pictures: self.sheet.is_some(),
        }
    }

    /// Every material that is asked for: each model of each width, then those by name.
    fn every_brdf(&self) -> anyhow::Result<Vec<Brdf>> {
        let models = if self.models.is_empty() { &[Analytic::BlinnPhong] } else { self.models.as_slice() };
        let of_exponent = |&exponent: &f32| models.iter().map(move |model| model.of_exponent(exponent.into()));
        let mut brdfs: Vec<Brdf> = self.exponents.iter().flat_map(of_exponent).collect();
        for brdf in &self.brdfs {
            brdfs.push(brdf.read()?);
        }
        Ok(brdfs)
    }

    /// The session's surface from every distance with every material; its own where none is asked for.
    fn points(&self, session: &Session, brdfs: &[Brdf]) -> Vec<Point> {
        let distances =
            if self.distances.is_empty() { &[session.surface.camera.distance] } else { &self.distances[..] };
        let materials = if brdfs.is_empty() { vec![None] } else { brdfs.iter().copied().map(Some).collect() };
        let mut points = Vec::new();
        for brdf in materials {
            for &distance in distances {
                let mut surface: LitSurface = session.surface.clone();
                surface.camera.distance = distance;
                if let Some(brdf) = brdf {
                    surface.material.set_brdf(brdf);
                }
                points.push(Point { surface, fit: *session.fit_settings() });
            }
        }
        points
    }

    fn session_of(&self, map: Option<&Path>) -> anyhow::Result<Session> {
        let start = Start { map, map_arguments: &self.map_arguments, fit: &self.fit, session: self.session.as_deref() };
        let model = self.look.model()?;
        let mut session = start.session(|file| {
            self.look.apply_to(&mut file.surface, model)?;
            let own = file.truth_samples.unwrap_or(PICTURE_SAMPLES).max(PICTURE_SAMPLES);
            file.truth_samples = Some(self.samples.unwrap_or(own));
            Ok(())
        })?;
        session.skip_previews();
        Ok(session)
    }
}
