//! What is found of each method, in each cell: a map, seen from a distance, of a material.

use serde::Serialize;

/// What is found of one method.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct MethodFigures {
    /// The method by name.
    pub method: String,
    /// Euclidean colour distance over the length of the reference's colour, averaged (Tan et al. 2005).
    pub normalised_color_error: Option<f64>,
    /// Root of the mean squared difference, linear RGB.
    pub rmse: Option<f64>,
    /// Mean FLIP error, over the covered pixels, of the pictures as they are displayed (Andersson et al. 2020).
    pub flip: Option<f64>,
    /// Of one frame of this method alone, where that was timed.
    pub milliseconds: Option<f64>,
    /// What a texel above the base level takes in the textures that the method reads.
    pub bytes_per_texel: u32,
    /// Mean change from frame to frame of a dolly, where that was measured; see [`dolly`](super::dolly).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub temporal_change: Option<f64>,
}

/// What the methods are held against.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Reference {
    /// Samples of the unfiltered map per pixel.
    pub samples_per_pixel: u32,
    /// Of the reference, in the normalisation of the colour error.
    pub standard_error: Option<f64>,
    /// Mean change from frame to frame of the truth itself, where that was measured.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub temporal_change: Option<f64>,
}

/// One map at one distance, of one material.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Cell {
    /// The map by path or name.
    pub map: String,
    /// From the eye to the surface's centre.
    pub distance: f32,
    /// The material's exponent; of other models than Blinn-Phong, that of the same width.
    pub exponent: f32,
    /// The material's BRDF by name.
    pub brdf: String,
    /// What the methods are held against.
    pub reference: Reference,
    /// What was found, in the order asked for.
    pub methods: Vec<MethodFigures>,
}

impl Cell {
    /// Map, distance and material, in words.
    pub fn title(&self) -> String {
        let Self { map, distance, exponent, brdf, .. } = self;
        match brdf.split_once(':') {
            Some(("blinn-phong", _)) => format!("{map}, distance {distance}, exponent {exponent}"),
            _ => format!("{map}, distance {distance}, {brdf}, as wide as exponent {exponent:.1}"),
        }
    }
}

/// The means over all cells, the figures of a single one.
pub fn mean(cells: &[Cell]) -> Option<(Reference, Vec<MethodFigures>)> {
    let first = cells.first()?;
    let of_method = |index: usize| {
        let all: Vec<&MethodFigures> = cells.iter().filter_map(|cell| cell.methods.get(index)).collect();
        MethodFigures {
            method: first.methods[index].method.clone(),
            normalised_color_error: mean_of(all.iter().map(|figures| figures.normalised_color_error)),
            rmse: mean_of(all.iter().map(|figures| figures.rmse)),
            flip: mean_of(all.iter().map(|figures| figures.flip)),
            milliseconds: mean_of(all.iter().map(|figures| figures.milliseconds)),
            bytes_per_texel: first.methods[index].bytes_per_texel,
            temporal_change: mean_of(all.iter().map(|figures| figures.temporal_change)),
        }
    };
    let standard_error = mean_of(cells.iter().map(|cell| cell.reference.standard_error));
    let temporal_change = mean_of(cells.iter().map(|cell| cell.reference.temporal_change));
    let methods = (0..first.methods.len()).map(of_method).collect();
    Some((Reference { standard_error, temporal_change, ..first.reference }, methods))
}

/// In how many cells each method has the lowest colour error of all, the truth left aside.
pub fn lowest_in(cells: &[Cell]) -> Vec<usize> {
    let mut lowest = vec![0; cells.first().map_or(0, |cell| cell.methods.len())];
    for cell in cells {
        let errors = cell.methods.iter().enumerate().filter(|(_, figures)| figures.method != "truth");
        let known = errors.filter_map(|(index, figures)| Some((index, figures.normalised_color_error?)));
        if let Some((index, _)) = known.min_by(|a, b| a.1.total_cmp(&b.1)) {
            lowest[index] += 1;
        }
    }
    lowest
}

fn mean_of(values: impl Iterator<Item = Option<f64>>) -> Option<f64> {
    let (sum, count) = values.flatten().fold((0.0, 0_u32), |(sum, count), value| (sum + value, count + 1));
    (count > 0).then(|| sum / f64::from(count))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cell(errors: [Option<f64>; 2]) -> Cell {
        let figures = |normalised_color_error| MethodFigures {
            method: "mip".to_owned(),
            normalised_color_error,
            rmse: None,
            flip: None,
            milliseconds: Some(1.0),
            bytes_per_texel: 16,
            temporal_change: None,
        };
        let reference = Reference { samples_per_pixel: 1024, standard_error: Some(0.5), temporal_change: None };
        let methods = errors.map(figures).to_vec();
        let brdf = "blinn-phong:64".to_owned();
        Cell { map: "waves".to_owned(), distance: 3.0, exponent: 64.0, brdf, reference, methods }
    }

    #[test]
    fn means_leave_out_what_is_not_known() {
        let cells = [cell([Some(0.1), None]), cell([Some(0.3), None])];
        let (reference, methods) = mean(&cells).expect("two cells");
        assert_eq!(reference.standard_error, Some(0.5));
        assert!(methods[0].normalised_color_error.is_some_and(|error| (error - 0.2).abs() < 1e-12));
        assert_eq!(methods[1].normalised_color_error, None);
        assert_eq!(mean(&[]), None);
    }

    #[test]
    fn a_cell_is_won_by_its_lowest_error() {
        let cells = [cell([Some(0.1), Some(0.2)]), cell([Some(0.3), Some(0.2)]), cell([None, Some(0.2)])];
        assert_eq!(lowest_in(&cells), [1, 2]);
    }
}
