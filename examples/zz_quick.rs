// Compare quick with slow, count doubts; time.
use enfilade::*;
use enfilade::render::room_views;
use std::time::Instant;
fn main(){
    for path in std::env::args().skip(1){
        let scene=Scene::open(path.as_ref()).unwrap();
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
        for (name,rays) in [("primary",&rays),("random",&rs)]{
            let mut best=[f64::INFINITY;3];
            let mut sum=0.0;
            for _ in 0..5{
                let t=Instant::now(); for (c,r) in rays{ sum+=scene.trace_brief(Start::Cell(*c),r).t.min(1e3);} best[0]=best[0].min(t.elapsed().as_secs_f64());
                let t=Instant::now(); for (c,r) in rays{ sum+=scene.trace_from(Start::Cell(*c),r,Want::LEAST).t.min(1e3);} best[1]=best[1].min(t.elapsed().as_secs_f64());
            }
            let (mut none,mut diff,mut tri,mut worst)=(0,0,0,0f64);
            for (c,r) in rays{
                let b=scene.trace_brief(Start::Cell(*c),r);
                if !scene.is_quick(*c,r){none+=1}
                let (h,_)=scene.trace_cost_from(Start::Cell(*c),r,Want::LEAST);
                let e=(h.t-b.t).abs(); if h.t!=b.t{ worst=worst.max(e); if e>1e-5 || e.is_nan(){diff+=1;} }
                if h.triangle!=NONE && b.triangle!=NONE && scene.element_of(h.triangle)!=scene.element_of(b.triangle){tri+=1}
            }
            println!("{path} {name}: brief {:.1} ns hit {:.1} ns doubt {:.4} differ {diff} elements {tri} worst {worst:.1e} {}",best[0]*1e9/rays.len() as f64,best[1]*1e9/rays.len() as f64,none as f64/rays.len() as f64,sum as u64%10);
        }
    }
}
