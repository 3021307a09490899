//! Pictures by packets against those by rays and by beams, and what each pixel is written by.

use proptest::prelude::*;

use super::band::LARGEST;
use super::waiting::Waiting;
use super::{PacketCounts, Packets};
use crate::Scene;
use crate::beam::check::{UNWRITTEN, compare};
use crate::beam::tests::{SIZE, scenes, total, touching_views, views};
use crate::beam::{Beams, Differences};
use crate::render::Camera;
use crate::samples::Sample;
use crate::trace::Kernel;

fn sum(packets: &mut Packets<&Scene>, views: &[Camera]) -> Differences {
    let [width, height] = SIZE;
    total(views, |camera| packets.differences(camera, width, height))
}

#[test]
fn pixels_show_what_rays_meet() {
    for (name, scene) in scenes() {
        let sum = sum(&mut Packets::new(scene), &views(scene, 12));
        assert!(sum.pixels > 0, "{name}");
        assert_eq!(sum.unwritten, 0, "{name}");
        assert!(sum.unsure * 1000 <= sum.pixels, "{name}: {} unsure of {}", sum.unsure, sum.pixels);
        assert!(sum.ties * 40_000 <= sum.pixels, "{name}: {} ties of {}", sum.ties, sum.pixels);
        assert!(sum.wrong.is_empty(), "{name}: {} wrong, {:?}", sum.wrong.len(), sum.wrong[0]);
    }
}

#[test]
fn eyes_in_planes_and_on_corners() {
    let [width, height] = SIZE;
    for (name, scene) in scenes().into_iter().take(6) {
        let mut packets = Packets::new(scene);
        let sum = total(&touching_views(scene), |camera| packets.differences(camera, width, height));
        assert_eq!(sum.unwritten, 0, "{name}");
        assert!(sum.unsure < sum.pixels, "{name}: {} of {}", sum.unsure, sum.pixels);
        assert!(sum.wrong.is_empty(), "{name}: {} {:?}", sum.wrong.len(), sum.wrong[0]);
    }
}

#[test]
fn kernels_agree() {
    let [width, height] = SIZE;
    for (name, scene) in scenes().into_iter().take(5) {
        for camera in views(scene, 6) {
            let shown: Vec<Vec<u32>> = Kernel::available()
                .into_iter()
                .map(|kernel| {
                    let mut pixels = vec![0; (width * height) as usize];
                    Packets::new(scene).with_kernel(kernel).surfaces(&camera, width, &mut pixels);
                    pixels
                })
                .collect();
            assert!(shown.iter().all(|pixels| *pixels == shown[0]), "{name}");
        }
    }
}

/// Pixels are as bright as beams make them; few on edges show what is beside them.
#[test]
fn colours_are_those_of_beams() {
    let [width, height] = SIZE;
    for (name, scene) in scenes() {
        let (mut packets, mut beams) = (Packets::new(scene), Beams::new(scene));
        let (mut pixels, mut others) = (0, 0);
        for camera in views(scene, 6) {
            let [mut ours, mut theirs] = [0; 2].map(|pixel| vec![pixel; (width * height) as usize]);
            packets.paint(&camera, width, &mut ours);
            beams.paint(&camera, width, &mut theirs);
            pixels += ours.len();
            others += ours.iter().zip(&theirs).filter(|(a, b)| a != b).count();
        }
        assert!(others * 10_000 <= pixels, "{name}: {others} of {pixels}");
    }
}

#[test]
fn each_pixel_is_written_once() {
    for (name, scene) in scenes() {
        let mut packets = Packets::new(scene);
        for (index, camera) in views(scene, 10).iter().enumerate() {
            // Of pictures narrower than a register, and not of whole ones.
            let [width, height] = [SIZE, [1, 1], [15, 3], [16, 129], [131, 300]][index % 5];
            let mut sizes = vec![UNWRITTEN; (width * height) as usize];
            let counts = packets.sizes(camera, width, &mut sizes);
            // What each packet writes, together as many as there are: none twice if none is left out.
            assert_eq!(counts.whole + counts.apart + counts.rays, sizes.len() as u64, "{name}");
            assert!(!sizes.contains(&UNWRITTEN), "{name}");
        }
    }
}

#[test]
fn sizes_are_those_of_packets() {
    let [width, height] = SIZE;
    let scene = Sample::Build1.scene();
    let mut packets = Packets::new(scene);
    let (mut sizes, mut sum) = (vec![0; (width * height) as usize], PacketCounts::default());
    for camera in views(scene, 6) {
        let counts = packets.sizes(&camera, width, &mut sizes);
        let apart = sizes.iter().filter(|&&size| size == 1).count() as u64;
        assert_eq!(apart, counts.apart);
        assert!(sizes.iter().all(|&size| (1..=LARGEST as u32).contains(&size)));
        sum.add(&counts);
    }
    assert!(sum.whole > sum.apart && sum.apart > 0 && sum.leaves > 0, "{sum:?}");
    assert!(sum.packets > sum.leaves + sum.splits, "{sum:?}");
}

#[test]
fn bands_and_threads_do_not_matter() {
    let [width, _] = SIZE;
    let height = 2 * LARGEST as u32 + 77;
    let scene = Sample::Build1.scene();
    let mut packets = Packets::new(scene);
    for camera in views(scene, 4) {
        let mut pixels = vec![UNWRITTEN; (width * height) as usize];
        packets.surfaces(&camera, width, &mut pixels);
        let differences = compare(scene, &camera, width, &pixels);
        assert_eq!(differences.unwritten, 0);
        assert!(differences.wrong.is_empty(), "{:?}", differences.wrong[0]);
        #[cfg(feature = "rayon")]
        for threads in [1, 3] {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            let mut again = vec![UNWRITTEN; pixels.len()];
            pool.install(|| packets.surfaces(&camera, width, &mut again));
            assert!(pixels == again, "{threads} threads");
        }
    }
}

#[test]
fn from_outside_and_from_within_a_solid() {
    let scene = Sample::House.scene();
    let [lo, hi] = scene.hull();
    let middle = [0, 1, 2].map(|i| (lo[i] + hi[i]) / 2.0);
    let eye = [lo[0] - 9.0, lo[1] - 7.0, hi[2] + 3.0];
    let outside = Camera::look_at(eye, middle, [0.0, 0.0, 1.0], 60.0).unwrap();
    let [width, height] = SIZE;
    let differences = Packets::new(scene).differences(&outside, width, height);
    assert_eq!(differences.unwritten, 0);
    assert!(differences.wrong.is_empty(), "{:?}", differences.wrong[0]);
    let mut pixels = vec![0; (width * height) as usize];
    let wall = scene.triangle(0).map(glam::DVec3::from);
    let within = (wall[0] + wall[1] + wall[2]) / 3.0;
    let camera = Camera::looking(within.to_array(), [1.0, 0.2, 0.1], [0.0, 0.0, 1.0], 60.0).unwrap();
    Packets::new(scene).paint(&camera, width, &mut pixels);
    assert!(pixels.iter().all(|&pixel| pixel >> 24 == 0xff));
}

#[test]
fn pictures_without_pixels() {
    let scene = Sample::House.scene();
    let camera = views(scene, 1)[0];
    let mut packets = Packets::new(scene);
    assert_eq!(packets.paint(&camera, 0, &mut []), PacketCounts::default());
    assert_eq!(packets.paint(&camera, 7, &mut [0; 6]), PacketCounts::default());
}

proptest! {
    /// Whatever the order in which parts of rows come, each of their pixels is drawn once.
    #[test]
    fn parts_of_rows_are_drawn_once(
        ends in prop::collection::vec(prop::collection::btree_set(0i32..60, 0..12), 1..9),
        order in any::<u64>(),
    ) {
        let rows = ends.len();
        let mut parts: Vec<(usize, [i32; 2])> = Vec::new();
        for (row, ends) in ends.iter().enumerate() {
            let ends: Vec<i32> = ends.iter().copied().collect();
            // Some touch, and between others there is room.
            let kept = ends.windows(2).enumerate().filter(|(i, _)| (order >> i) & 3 != 0);
            parts.extend(kept.map(|(_, w)| (row, [w[0], w[1]])));
        }
        let mut told = vec![[0u8; 60]; rows];
        for (row, part) in &parts {
            (part[0]..part[1]).for_each(|column| told[*row][column as usize] += 1);
        }
        let mut random = crate::splitmix::SplitMix64::new(order);
        parts.sort_by_cached_key(|_| random.bits());
        let mut waiting = Waiting::new();
        for _ in 0..2 {
            waiting.begin(rows);
            parts.iter().for_each(|&(row, part)| waiting.area(3).add(row, part));
            let mut drawn = vec![[0u8; 60]; rows];
            for area in waiting.all() {
                prop_assert_eq!(area.detail, 3);
                area.draw(|first, parts| {
                    for (row, part) in (first..).zip(parts) {
                        (part[0]..part[1]).for_each(|column| drawn[row][column as usize] += 1);
                    }
                });
            }
            prop_assert_eq!(&drawn, &told);
        }
    }
}
