//! Where four texels meet: the lines of corners between rows, or columns, of texels.

use crate::normal_map::Addressing;

/// Lines of corners along an axis that count: the last is the first again where the map tiles.
pub fn lines(size: usize, addressing: Addressing) -> usize {
    size + usize::from(addressing == Addressing::Clamp)
}

/// The texels on either side of corner line `index` along an axis.
pub fn line(index: usize, size: usize, addressing: Addressing) -> [usize; 2] {
    match addressing {
        Addressing::Wrap => [(index + size - 1) % size, index % size],
        Addressing::Clamp => [index.max(1) - 1, index.min(size - 1)],
    }
}

/// The share of texel `index` in the corner line before it (`side` 0) or behind it (1), along an axis.
pub fn share(index: usize, side: usize, size: usize, addressing: Addressing) -> f32 {
    match addressing {
        // A single texel borders on itself, in one line.
        Addressing::Wrap if size == 1 => [1.0, 0.0][side],
        Addressing::Wrap => 0.5,
        Addressing::Clamp if index + side == 0 || index + side == size => 1.0,
        Addressing::Clamp => 0.5,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_corner_is_shared_out_whole() {
        for addressing in [Addressing::Wrap, Addressing::Clamp] {
            for size in 1..6 {
                let mut shares = [0.0; 7];
                for (index, side) in (0..size).flat_map(|index| [(index, 0), (index, 1)]) {
                    let at = index + side;
                    let counted = if at < lines(size, addressing) { at } else { 0 };
                    shares[counted] += share(index, side, size, addressing);
                    let beside = line(at, size, addressing).into_iter().filter(|&texel| texel == index).count();
                    let expected = beside as f32 / 2.0;
                    let same_line_twice = size == 1 && addressing == Addressing::Wrap && side == 1;
                    assert!(same_line_twice || share(index, side, size, addressing) == expected);
                }
                assert!(shares[..lines(size, addressing)].iter().all(|&share| share == 1.0), "{addressing:?}, {size}");
            }
        }
    }
}
