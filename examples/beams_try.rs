use enfilade::beam::Beams;
use enfilade::render::{room_views, RenderOptions, ColorMode, render};
use enfilade::Scene;
use std::time::Instant;
fn median(v: &mut Vec<f64>) -> f64 { v.sort_by(|a,b| a.total_cmp(b)); v[v.len()/2] }
fn main() {
    let path = std::env::args().nth(1).unwrap();
    let out = std::env::args().nth(2);
    let scene = Scene::open(path.as_ref()).unwrap();
    let views = room_views(&scene, 2);
    let step = views.len().div_ceil(20).max(1);
    let views: Vec<_> = views.into_iter().step_by(step).collect();
    let n = 1024u32;
    let mut px = vec![0u32; (n*n) as usize];
    let mut beams = Beams::new(&scene);
    if let Some(k) = std::env::var("K").ok() { beams = beams.with_kernel(enfilade::Kernel::by_name(&k).unwrap()); }
    let (mut ms, mut cells, mut spans, mut unsure, mut tris) = (vec![], 0, 0, 0, 0);
    for v in &views {
        let mut t = vec![];
        for _ in 0..9 { let s = Instant::now(); let c = beams.paint(v, n, &mut px); t.push(s.elapsed().as_secs_f64()*1e3);
            if t.len()==1 { cells += c.cells; spans += c.spans; unsure += c.unsure; tris += c.triangles; } }
        ms.push(median(&mut t));
    }
    let k = views.len() as f64;
    println!("{path}: {} views, median {:.3} ms, mean {:.3}, max {:.3}; cells {:.0}, spans {:.0}, unsure {:.4}, triangles {:.0}", views.len(), median(&mut ms.clone()), ms.iter().sum::<f64>()/k, ms.iter().cloned().fold(0.0,f64::max), cells as f64/k, spans as f64/k, unsure as f64/k/(n*n) as f64, tris as f64/k);
    if let Ok(k) = std::env::var("CHECK") {
        let mut all = (0u64, 0u64, 0u64, 0u64);
        for (i, v) in views.iter().enumerate().take(k.parse().unwrap()) {
            let d = beams.differences(v, n, n);
            all.0 += d.pixels; all.1 += d.unsure + d.unwritten; all.2 += d.ties; all.3 += d.wrong.len() as u64;
            if !d.wrong.is_empty() { println!("  view {i}: wrong {} {:?}", d.wrong.len(), &d.wrong[..d.wrong.len().min(3)]); }
        }
        let ppm = |c: u64| c as f64 / all.0 as f64 * 1e6;
        println!("  unsure {:.1} ppm, ties {:.1}, wrong {:.1}", ppm(all.1), ppm(all.2), ppm(all.3));
    }
    if let Some(out) = out {
        let which: usize = std::env::args().nth(3).map_or(0, |s| s.parse().unwrap());
        px.fill(0xff_00_00_ff);
        beams.paint(&views[which], n, &mut px);
        let bytes: Vec<u8> = px.iter().flat_map(|p| { let [r,g,b,_] = p.to_le_bytes(); [r,g,b] }).collect();
        image::save_buffer(format!("{out}.png"), &bytes, n, n, image::ColorType::Rgb8).unwrap();
        let pic = render(&scene, &views[which], &RenderOptions::new(n, n, ColorMode::Material)).unwrap();
        enfilade::render::write_png(&pic, format!("{out}_ray.png").as_ref()).unwrap();
    }
}
