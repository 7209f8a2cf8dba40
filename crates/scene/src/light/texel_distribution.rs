//! Choosing a texel of an equirectangular picture in proportion to its weight, without error from rounding.
//!
//! Row first, then column, each by inverting a cumulative table. Within a row the weights are rounded to
//! integers that sum to about 2³¹, at least 1 where the weight is positive: the probability that is reported
//! is exactly that of the choice, and no positive weight is lost.

/// A distribution over `width` × `height` texels.
#[derive(Debug, Clone)]
pub(super) struct TexelDistribution {
    width: usize,
    /// Cumulative probability after each row; the last is 1.
    rows: Vec<f64>,
    /// The last row with any weight: rounding may leave the last cumulative value a little below 1.
    last_row: usize,
    /// Cumulative quanta after each texel of each row.
    quanta: Vec<u32>,
    row_guide: Guide,
    column_guides: Vec<Guide>,
}

/// For each of equal parts of a cumulative table's range, which value is the first above where the part begins (the index
/// table of Chen & Asau 1974): what is left to search lies in a line or two of the cache.
#[derive(Debug, Clone)]
struct Guide([u32; GUIDE + 1]);

/// A power of two, so that the parts of a random number are exact.
const GUIDE: usize = 32;

impl Guide {
    /// `first_above(x)` is the number of values of the table up to the fraction x of its range.
    fn new(first_above: impl Fn(f64) -> usize) -> Self {
        Self(std::array::from_fn(|part| first_above(part as f64 / GUIDE as f64) as u32))
    }

    /// The numbers between which that of `u` in [0, 1) lies.
    fn between(&self, u: f64) -> [usize; 2] {
        let part = ((u * GUIDE as f64) as usize).min(GUIDE - 1);
        [self.0[part], self.0[part + 1]].map(|number| number as usize)
    }
}

/// A chosen texel.
pub(super) struct ChosenTexel {
    pub(super) column: usize,
    pub(super) row: usize,
    /// Where between the texel's edges the random numbers fell, uniform in [0, 1).
    pub(super) inside: [f64; 2],
    pub(super) probability: f64,
}

/// Quanta to share out among the texels of a row.
const QUANTA: f64 = 2_147_483_648.0;

/// Least probability of a row with any weight, times the number of rows.
const LEAST_ROW_SHARE: f64 = 1e-9;

impl TexelDistribution {
    /// `row_weights(row)` fills in finite, non-negative weights of the texels of a row. None if all are zero.
    pub(super) fn new(
        width: usize,
        height: usize,
        mut row_weights: impl FnMut(usize, &mut [f64]),
    ) -> Option<Self> {
        let mut rows = Vec::with_capacity(height);
        let mut quanta = Vec::with_capacity(width * height);
        let mut weights = vec![0.0; width];
        for row in 0..height {
            row_weights(row, &mut weights);
            let sum: f64 = weights.iter().sum();
            rows.push(sum);
            let mut cumulative = 0_u32;
            quanta.extend(weights.iter().map(|weight| {
                let share = if *weight > 0.0 { (weight / sum * QUANTA) as u32 } else { 0 };
                // Cannot wrap: at most 2³¹ in shares and one for each of fewer than 2³¹ texels.
                cumulative += share + u32::from(*weight > 0.0);
                cumulative
            }));
        }
        let total: f64 = rows.iter().sum();
        if total <= 0.0 {
            return None;
        }
        // A faint row beside a bright sun must not vanish in the rounding of the cumulative sum.
        let least = LEAST_ROW_SHARE * total / height as f64;
        let mut cumulative = 0.0;
        for row in &mut rows {
            cumulative += if *row > 0.0 { row.max(least) } else { 0.0 };
            *row = cumulative;
        }
        rows.iter_mut().for_each(|row| *row /= cumulative);
        let last = rows[height - 1];
        let last_row = rows.partition_point(|cumulative| *cumulative < last);
        let row_guide = Guide::new(|at| rows.partition_point(|cumulative| *cumulative <= at));
        let column_guides = quanta.chunks(width).map(|quanta| {
            let row_quanta = f64::from(quanta[width - 1]);
            Guide::new(|at| quanta.partition_point(|cumulative| f64::from(*cumulative) <= at * row_quanta))
        });
        let column_guides = column_guides.collect();
        Some(Self { width, rows, last_row, quanta, row_guide, column_guides })
    }

    /// A texel for `u` uniform in [0, 1)²: `u[0]` chooses the column, `u[1]` the row.
    pub(super) fn sample(&self, u: [f64; 2]) -> ChosenTexel {
        // Rows without weight have no width between cumulative values and are never chosen.
        let [from, to] = self.row_guide.between(u[1]);
        let row = from + self.rows[from..to].partition_point(|cumulative| *cumulative <= u[1]);
        let row = row.min(self.last_row);
        let row_start = if row == 0 { 0.0 } else { self.rows[row - 1] };
        let row_probability = self.rows[row] - row_start;

        let quanta = self.row_quanta(row);
        let row_quanta = f64::from(quanta[self.width - 1]);
        let target = u[0] * row_quanta;
        let [from, to] = self.column_guides[row].between(u[0]);
        let column = from + quanta[from..to].partition_point(|cumulative| f64::from(*cumulative) <= target);
        let column = column.min(self.width - 1);
        let column_start = if column == 0 { 0.0 } else { f64::from(quanta[column - 1]) };
        let column_quanta = f64::from(quanta[column]) - column_start;

        let just_below_one = 1.0 - f64::EPSILON / 2.0;
        ChosenTexel {
            column,
            row,
            inside: [
                ((target - column_start) / column_quanta).clamp(0.0, just_below_one),
                ((u[1] - row_start) / row_probability).clamp(0.0, just_below_one),
            ],
            probability: row_probability * column_quanta / row_quanta,
        }
    }

    /// Probability that [`sample`](Self::sample) chooses this texel.
    pub(super) fn probability(&self, column: usize, row: usize) -> f64 {
        let row_start = if row == 0 { 0.0 } else { self.rows[row - 1] };
        let quanta = self.row_quanta(row);
        let row_quanta = quanta[self.width - 1];
        if row_quanta == 0 {
            return 0.0;
        }
        let column_start = if column == 0 { 0 } else { quanta[column - 1] };
        (self.rows[row] - row_start) * f64::from(quanta[column] - column_start) / f64::from(row_quanta)
    }

    fn row_quanta(&self, row: usize) -> &[u32] {
        &self.quanta[row * self.width..][..self.width]
    }
}
