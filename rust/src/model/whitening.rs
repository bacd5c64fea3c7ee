//! Rows of a first-order autoregression made independent of each other, for many columns at once.

/// Weighted rows, each less its share of the row before, over what is new in it.
///
/// `columns` holds the rows one after the other, `width` numbers each, and so does `out`. `share[i]`
/// and `fresh[i]` belong to row `i + 1`: how much of it goes on from row `i`, and what of it, as a
/// standard deviation, does not.
pub fn whiten_weighted(
    columns: &[f64],
    width: usize,
    weight: &[f64],
    share: &[f64],
    fresh: &[f64],
    out: &mut [f64],
) {
    let Some((&first, rest)) = weight.split_first() else {
        return;
    };
    if width == 0 {
        return;
    }
    for (value, &column) in out.iter_mut().zip(columns).take(width) {
        *value = column * first;
    }
    let mut before = first;
    let rows = columns.windows(2 * width).step_by(width);
    let filled = out.chunks_exact_mut(width).skip(1);
    for ((((rows, out), &weight), &share), &fresh) in
        rows.zip(filled).zip(rest).zip(share).zip(fresh)
    {
        let (last, row) = rows.split_at(width);
        for ((value, &here), &there) in out.iter_mut().zip(row).zip(last) {
            *value = (here * weight - share * (there * before)) / fresh;
        }
        before = weight;
    }
}

#[cfg(test)]
mod tests {
    use super::whiten_weighted;

    #[test]
    fn rows_lose_their_share_of_the_row_before() {
        let columns = [1.0, 10.0, 2.0, 20.0, 4.0, 40.0];
        let mut out = [0.0; 6];
        whiten_weighted(
            &columns,
            2,
            &[1.0, 2.0, 3.0],
            &[0.5, 0.0],
            &[0.5, 1.0],
            &mut out,
        );
        assert_eq!(out, [1.0, 10.0, 7.0, 70.0, 12.0, 120.0]);
    }

    #[test]
    fn nothing_is_done_without_rows_or_columns() {
        whiten_weighted(&[], 0, &[], &[], &[], &mut []);
        whiten_weighted(&[], 0, &[1.0, 2.0], &[0.5], &[1.0], &mut []);
    }
}
