//! The closed forms beside plain sums.

use super::*;
use crate::filter::vmf::channel_phi::plain::product;
use crate::filter::vmf::monitor::Monitor;
use crate::normal_map::procedural;
use crate::normal_map::pyramid::Footprint;

const SLOTS: usize = 3;

/// Lobes and normals of a texel, or of where several meet: `(alpha, alpha r)` and `(w, w n)`.
#[derive(Clone, Default)]
struct Place {
    lobes: Vec<[f64; 4]>,
    normals: Vec<[f64; 4]>,
}

impl Place {
    fn of(map: &NormalMap, size: (usize, usize), (x, y): (usize, usize), stored: &[StoredLobe]) -> Self {
        let mut own = Self::default();
        crowd::each_normal(map, &Footprint::new((map.width, map.height), size, (x, y)), |_, n, weight| {
            own.normals.push([1.0, n[0], n[1], n[2]].map(|value| f64::from(weight * value)));
        });
        let total: f64 = own.normals.iter().map(|normal| normal[0]).sum();
        own.normals.iter_mut().flatten().for_each(|value| *value /= total);
        own.lobes = stored[(y * size.0 + x) * SLOTS..][..SLOTS].iter().map(|lobe| lobe.map(f64::from)).collect();
        own
    }

    fn mean(places: &[Self]) -> Self {
        let share = 1.0 / places.len() as f64;
        let lobe = |j: usize| [0, 1, 2, 3].map(|p| places.iter().map(|place| share * place.lobes[j][p]).sum());
        let normals = places.iter().flat_map(|place| &place.normals).map(|n| n.map(|value| share * value));
        Self { lobes: (0..SLOTS).map(lobe).collect(), normals: normals.collect() }
    }

    fn square(&self) -> f64 {
        sum(&self.normals, &self.normals)
    }

    /// The squared distance between the lobes' and the normals' look, short of the latter's square.
    fn distance(&self) -> f64 {
        sum(&self.lobes, &self.lobes) - 2.0 * sum(&self.lobes, &self.normals)
    }
}

fn sum(a: &[[f64; 4]], b: &[[f64; 4]]) -> f64 {
    let pairs = a.iter().flat_map(|a| b.iter().map(move |b| (*a, *b)));
    pairs.filter(|(a, b)| a[0] > 0.0 && b[0] > 0.0).map(|(a, b)| product(a, b)).sum()
}

/// E texel by texel and corner by corner.
fn plain(map: &NormalMap, size: (usize, usize), addressing: Addressing, stored: &[StoredLobe]) -> f64 {
    let texel = |x, y| Place::of(map, size, (x, y), stored);
    let all = |size: (usize, usize)| (0..size.1).flat_map(move |y| (0..size.0).map(move |x| (x, y)));
    let centres = all(size).map(|(x, y)| texel(x, y)).map(|place| place.distance() / place.square());
    let corner = |(i, j)| {
        let (columns, rows) = (line(i, size.0, addressing), line(j, size.1, addressing));
        let around: Vec<Place> = rows.into_iter().flat_map(|y| columns.map(|x| texel(x, y))).collect();
        let square = around.iter().map(Place::square).sum::<f64>() / 4.0;
        Place::mean(&around).distance() / square
    };
    let corners = all((lines(size.0, addressing), lines(size.1, addressing))).map(corner);
    f64::from(CENTRE) * centres.sum::<f64>() + corners.sum::<f64>()
}

#[test]
fn e_is_the_plain_sum_over_texels_and_corners() {
    let mut map = procedural::find("bricks").expect("bundled").make(22);
    (map.x[60], map.y[60], map.z[60], map.invalid) = (0.0, 0.0, 0.0, 1);
    let size = map.level_size(2);
    let lobe = |i: usize| {
        let t = i as f32;
        let alpha = [0.5, 0.3, 0.2][i % SLOTS];
        [alpha, 0.3 * alpha * t.sin(), 0.3 * alpha * (1.7 * t).cos(), 0.8 * alpha]
    };
    let mut stored: Vec<StoredLobe> = (0..size.0 * size.1 * SLOTS).map(lobe).collect();
    stored[4] = [0.0; 4];
    let monitor = Monitor::new(vec![0; 5]);
    for addressing in [Addressing::Wrap, Addressing::Clamp] {
        let level = Level { level: 2, size, slots: SLOTS, addressing, monitor: &monitor };
        let joint = JointRows::new(&map, level).expect("small footprints");
        let found = joint.strip(&stored, 0, None, &mut stored.clone(), &mut joint.room()).expect("nobody cancels");
        let exact = plain(&map, size, addressing, &stored);
        assert!((found / exact - 1.0).abs() < 1e-4, "{addressing:?}: {found} {exact}");
    }
}
