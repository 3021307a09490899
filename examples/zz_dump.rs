use enfilade::*;
use enfilade::render::room_views;
use std::io::Write;
fn main(){
    for path in std::env::args().skip(1){
        let scene=Scene::open(path.as_ref()).unwrap();
        let name=std::path::Path::new(&path).file_stem().unwrap().to_string_lossy().into_owned();
        let views=room_views(&scene,2);
        let step=views.len().div_ceil(20).max(1);
        let mut rays=vec![];
        for v in views.iter().step_by(step){
            let Place::Air{cell,..}=scene.locate(v.eye()) else{continue};
            let p=v.pinhole(256,256);
            for y in 0..256{for x in 0..256{ rays.push((cell,p.ray(x,y))); }}
        }
        let mut s=12345u64; let mut rnd=||{s=s.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407); (s>>11) as f64/(1u64<<53) as f64};
        let rooms:Vec<_>=scene.rooms().filter(|r|r.is_closed()).map(|r|r.bounds()).collect();
        let mut rs=vec![];
        while rs.len()<300000{ let b=rooms[(rnd()*rooms.len() as f64) as usize]; let p=[0,1,2].map(|i|b[0][i]+(b[1][i]-b[0][i])*rnd());
          if let Place::Air{cell,room:Some(_),..}=scene.locate(p){ let z=2.0*rnd()-1.0; let a=6.283185307*rnd(); let r=(1.0-z*z).sqrt(); rs.push((cell,Ray::new(p,[r*a.cos(),r*a.sin(),z])));}}
        for (kind,rays) in [("primary",&rays),("random",&rs)]{
            let mut f=std::io::BufWriter::new(std::fs::File::create(format!("/tmp/rays/{name}.{kind}")).unwrap());
            for (c,r) in rays{ f.write_all(&c.to_le_bytes()).unwrap(); for v in r.origin.iter().chain(&r.direction){f.write_all(&v.to_le_bytes()).unwrap();} }
        }
    }
}
