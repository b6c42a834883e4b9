//! Tests of the best-subset search on planted supports.

use super::*;
use sidc_progress::Unwatched;
use sidc_random::Numbers;

/// Random columns, and a target of the columns 7 and 19 with noise.
fn planted(rows: usize, count: usize) -> (Vec<f64>, Vec<f64>) {
    let columns = Numbers(3).many(rows * count);
    let error = Numbers(5).many(rows);
    let column = |j: usize| &columns[j * rows..(j + 1) * rows];
    let target = (0..rows).map(|i| 2.0 * column(7)[i] - 0.5 * column(19)[i] + 0.1 * error[i]);
    let target = target.collect();
    (columns, target)
}

#[test]
fn planted_supports_are_found_in_noise() {
    let (rows, count) = (120, 40);
    let (columns, target) = planted(rows, count);
    let criterion = InformationCriterion::new(rows, 1.0, count, 0.0);
    let best =
        &BestSubsetSearch::new(rows, columns, target, 0.0, criterion).run(10, &[], &mut Unwatched)
            [0];
    assert_eq!(best.support, vec![7, 19]);
}

#[test]
fn below_the_floor_a_better_fit_is_no_evidence() {
    let (rows, count) = (100, 20);
    let columns = Numbers(11).many(rows * count);
    let column = |j: usize| &columns[j * rows..(j + 1) * rows];
    let target: Vec<f64> = (0..rows)
        .map(|i| column(2)[i] + 1e-6 * column(5)[i])
        .collect();
    let run = |floor: f64| {
        let criterion = InformationCriterion::new(rows, 1.0, count, floor * floor);
        let search = BestSubsetSearch::new(rows, columns.clone(), target.clone(), 0.0, criterion);
        search.run(10, &[], &mut Unwatched)[0].support.clone()
    };
    assert_eq!(run(1e-4), vec![2]);
    assert_eq!(run(1e-9), vec![2, 5]);
}

#[test]
fn what_is_required_is_in_every_subset() {
    let (rows, count) = (120, 30);
    let (columns, target) = planted(rows, count);
    let criterion = InformationCriterion::new(rows, 1.0, count, 0.0);
    let search =
        BestSubsetSearch::new(rows, columns.clone(), target, 0.0, criterion).requiring(vec![4, 19]);
    let found = search.run(10, &[vec![1, 2]], &mut Unwatched);
    assert_eq!(found[0].support, vec![4, 7, 19]);
    for subset in &found {
        assert!(subset.support.contains(&4) && subset.support.contains(&19));
    }
    // More of them than terms are allowed otherwise.
    let all = search.requiring((0..12).collect());
    assert!(all.run(3, &[], &mut Unwatched)[0].support.len() >= 12);
}

#[test]
fn neighbours_are_those_of_projections() {
    let (rows, count) = (60, 20);
    let columns = Numbers(21).many(rows * count);
    let target = Numbers(22).many(rows);
    let criterion = InformationCriterion::new(rows, 1.0, count, 0.0);
    let search = BestSubsetSearch::new(rows, columns, target, 0.0, criterion).requiring(vec![12]);
    let support = [2, 3, 11, 12, 17];
    let mut expected = Vec::new();
    for dropped in [Some(2), Some(3), Some(11), Some(17), None] {
        let kept: Vec<usize> = support
            .into_iter()
            .filter(|j| Some(*j) != dropped)
            .collect();
        let state = search.project(&kept);
        expected.push(search.subset(&state));
        let mut gains = Products::new(&search, &state).gains(&kept);
        gains.sort_by(|a, b| b.0.total_cmp(&a.0));
        let best = gains.iter().take(SUBSET_SEARCH.additions);
        expected.extend(best.map(|(_, j)| search.subset(&search.with(&state, *j))));
    }
    let found = search.neighbours(&support, 10, &mut Unwatched);
    assert_eq!(found.len(), expected.len());
    for (one, other) in found.iter().zip(&expected) {
        assert_eq!(one.support, other.support);
        assert!((one.value - other.value).abs() < 1e-9 * other.value.abs());
    }
}

#[test]
fn duplicated_columns_are_chosen_once() {
    let rows = 30;
    let one = Numbers(9).many(rows);
    let columns = [one.clone(), one.clone(), Numbers(10).many(rows)].concat();
    let criterion = InformationCriterion::new(rows, 1.0, 3, 1e-20);
    let best =
        &BestSubsetSearch::new(rows, columns, one, 0.0, criterion).run(3, &[], &mut Unwatched)[0];
    assert_eq!(best.support.len(), 1);
}
