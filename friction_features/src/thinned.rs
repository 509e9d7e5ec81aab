//! Curves of a few hundred points from runs of any length.

/// Most rows that are kept.
const CAPACITY: usize = 500;

/// Keeps every n-th row of a run whose length need not be known: when full, every second row goes
/// and n doubles. So between half of the capacity and all of it are left, evenly spaced, with the
/// first row among them.
#[derive(Debug, Clone)]
pub(crate) struct Thinned<const COLUMNS: usize> {
    rows: Vec<[f64; COLUMNS]>,
    stride: usize,
    offered: usize,
}

impl<const COLUMNS: usize> Thinned<COLUMNS> {
    pub(crate) const fn new() -> Self {
        Self { rows: Vec::new(), stride: 1, offered: 0 }
    }

    pub(crate) fn offer(&mut self, row: [f64; COLUMNS]) {
        if self.offered.is_multiple_of(self.stride) {
            if self.rows.len() == CAPACITY {
                let mut place = 0;
                self.rows.retain(|_| {
                    place += 1;
                    place % 2 == 1
                });
                self.stride *= 2;
            }
            if self.offered.is_multiple_of(self.stride) {
                self.rows.push(row);
            }
        }
        self.offered += 1;
    }

    /// One list a column.
    pub(crate) fn columns(&self) -> [Vec<f64>; COLUMNS] {
        std::array::from_fn(|i| self.rows.iter().map(|row| row[i]).collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn any_number_of_rows_is_thinned_evenly() {
        for length in [0, 1, CAPACITY - 1, CAPACITY, CAPACITY + 1, 2 * CAPACITY, 100_003] {
            let mut thinned = Thinned::new();
            for k in 0..length {
                thinned.offer([k as f64, -(k as f64)]);
            }
            let [x, y] = thinned.columns();
            assert!(
                x.len() <= CAPACITY && x.len() >= length.min(CAPACITY / 2),
                "{length}: {}",
                x.len()
            );
            assert!(length == 0 || x[0] == 0.0);
            assert!(x.windows(2).all(|pair| pair[1] - pair[0] == thinned.stride as f64));
            assert!(x.iter().zip(&y).all(|(x, y)| *x == -*y));
        }
    }
}
