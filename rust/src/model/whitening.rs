//! Rows of correlated noise made independent of each other, for many columns at once.

/// Weighted rows, each less its share of the row before and of what was new there, over what is new
/// in it: the noise is a first-order autoregression, with a white part beside it or without.
///
/// `columns` holds the rows one after the other, `width` numbers each, and so does `out`. `share[i]`,
/// `carried[i]` and `fresh[i]` belong to row `i + 1`: how much of it goes on from row `i`, how much
/// from what was new in row `i` (zero without a white part), and what of it, as a standard deviation,
/// does neither.
pub fn whiten_weighted(
    columns: &[f64],
    width: usize,
    weight: &[f64],
    share: &[f64],
    carried: &[f64],
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
    let (mut new, mut rest_of_out) = out.split_at_mut(width);
    let rows = columns.windows(2 * width).step_by(width);
    for ((((rows, &weight), &share), &carried), &fresh) in
        rows.zip(rest).zip(share).zip(carried).zip(fresh)
    {
        let (last, row) = rows.split_at(width);
        let (out, further) = std::mem::take(&mut rest_of_out).split_at_mut(width);
        for (((value, &new), &here), &there) in out.iter_mut().zip(&*new).zip(row).zip(last) {
            *value = (here * weight - share * (there * before) - carried * new) / fresh;
        }
        before = weight;
        (new, rest_of_out) = (out, further);
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
            &[0.0, 0.0],
            &[0.5, 1.0],
            &mut out,
        );
        assert_eq!(out, [1.0, 10.0, 7.0, 70.0, 12.0, 120.0]);
    }

    #[test]
    fn rows_lose_their_share_of_what_was_new_before() {
        let mut out = [0.0; 3];
        whiten_weighted(
            &[1.0, 2.0, 4.0],
            1,
            &[1.0, 1.0, 1.0],
            &[0.5, 0.5],
            &[-0.5, -0.25],
            &[0.5, 1.0],
            &mut out,
        );
        assert_eq!(out, [1.0, 4.0, 4.0]);
    }

    #[test]
    fn nothing_is_done_without_rows_or_columns() {
        whiten_weighted(&[], 0, &[], &[], &[], &[], &mut []);
        whiten_weighted(&[], 0, &[1.0, 2.0], &[0.5], &[0.0], &[1.0], &mut []);
    }
}
