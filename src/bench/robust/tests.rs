use enfilade_importers::CancelToken;

use super::*;
use crate::generate::{HouseOptions, house};

/// Without furniture: it is compiled again and again.
fn bare() -> Building {
    house(&HouseOptions { furniture: false, ..HouseOptions::default() })
}

fn few() -> RobustOptions {
    RobustOptions { rays: 2000, verified: 2000, repeat: 1, ..RobustOptions::default() }
}

#[test]
fn a_building_as_drawn_is_its_own_truth() {
    let report = robust(&bare(), &RobustOptions { damages: Vec::new(), ..few() }).unwrap();
    let drawn = report.drawn;
    assert_eq!((drawn.joins_found, drawn.joins_right, drawn.leaky_pairs), (1.0, Some(1.0), 0));
    assert!(drawn.volume_error[1] < 1e-9 && drawn.void_volume == 0.0, "{drawn:?}");
    assert_eq!((drawn.other_element, drawn.leaks, drawn.in_solid, drawn.wrong), (0, 0, 0, 0));
    assert_eq!(drawn.moved_rms, 0.0);
    assert!(drawn.rays == 2000 && drawn.verified >= 2000 && drawn.ns_per_ray > 0.0);
}

#[test]
fn damage_is_seen_in_what_it_touches() {
    // Jitter of a centimetre makes tens of thousands of cells.
    let (jitter, others): (Vec<_>, Vec<_>) = Damage::ALL.into_iter().partition(|it| *it == Damage::Jitter);
    let mut report = robust(&bare(), &RobustOptions { damages: others, sizes: vec![1e-2], ..few() }).unwrap();
    let options = RobustOptions { damages: jitter, sizes: vec![2e-3], ..few() };
    report.rows.extend(robust(&bare(), &options).unwrap().rows);
    assert_eq!(report.rows.len(), Damage::ALL.len());
    let of = |damage| *report.rows.iter().find(|row| row.damage == Some(damage)).unwrap();
    assert!(report.rows.iter().all(|row| row.wrong == 0), "{}", report.text());
    // Rooms are labels: no ray meets them.
    for damage in [Damage::RoomGaps, Damage::RoomOverlaps] {
        let row = of(damage);
        assert_eq!((row.other_element, row.leaks, row.in_solid, row.moved_rms), (0, 0, 0, 0.0));
        assert_eq!((row.joins_found, row.joins_right), (1.0, Some(1.0)));
    }
    // Walls that move by a centimetre move what rays meet there.
    for damage in [Damage::SolidGaps, Damage::SolidOverlaps, Damage::Noise] {
        assert!((1e-3..5e-2).contains(&of(damage).moved_rms), "{}", report.text());
    }
    assert!((2e-4..1e-2).contains(&of(Damage::Jitter).moved_rms), "{}", report.text());
    // Where nothing is closed there are no solids to cut cells from.
    assert!(of(Damage::Noise).cells < report.drawn.cells && of(Damage::Noise).joins_found < 1.0);
}

#[test]
fn reports_are_told_and_drawn() {
    let options = RobustOptions {
        damages: vec![Damage::RoomGaps, Damage::SolidGaps],
        sizes: vec![1e-4, 1e-2],
        ..few()
    };
    let report = robust(&bare(), &options).unwrap();
    let lines: Vec<String> = report.text().lines().map(str::to_owned).collect();
    assert_eq!(lines.len(), 2 + 1 + 4);
    assert!(lines[2].starts_with("as drawn") && lines[6].starts_with("solid-gaps"), "{lines:#?}");
    assert_eq!(report.markdown().lines().filter(|line| line.starts_with('|')).count(), 2 + 1 + 4);
    let svg = crate::plan::plan_svg(&report.chart());
    assert!(svg.contains("solid-gaps, 0.01 m") && !svg.contains("NaN"), "{svg}");
}

#[test]
fn cancelled() {
    let cancel = CancelToken::default();
    cancel.cancel();
    let watch = Watch::default().with_cancel(cancel);
    let stopped = robust(&bare(), &RobustOptions { watch, ..few() });
    assert!(matches!(stopped, Err(RobustError::Cancelled(_))), "{stopped:?}");
}

#[test]
fn sizes_that_are_none_are_left_out() {
    let (damages, sizes) =
        (vec![Damage::Jitter, Damage::Jitter], vec![1e-3, 0.0, f64::NAN, 1e-3, -1.0, 1e300]);
    let report = robust(&bare(), &RobustOptions { damages, sizes, ..few() }).unwrap();
    assert_eq!(report.rows.iter().map(|row| row.size).collect::<Vec<_>>(), [1e-3]);
}

/// Where corners are welded, as far as that goes, and past it.
#[test]
fn noise_up_to_where_nothing_closes_is_answered_rightly() {
    let (damages, sizes) = (vec![Damage::Noise], vec![1.1e-3, 2.3e-3]);
    let options = RobustOptions { damages, sizes, verified: 8_000, ..few() };
    let report = robust(&house(&HouseOptions::default()), &options).unwrap();
    assert!(report.rows.iter().all(|row| row.wrong == 0 && row.verified > 8_000), "{}", report.text());
    assert!(report.rows[0].joins_found > 0.9, "{}", report.text());
}
