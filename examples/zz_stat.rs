use enfilade::*;
use enfilade::render::room_views;
fn main(){
    for path in std::env::args().skip(1){
        let scene=Scene::open(path.as_ref()).unwrap();
        let views=room_views(&scene,2);
        let step=views.len().div_ceil(20).max(1);
        let (mut n,mut c)=(0f64,[0f64;6]);
        let mut rays=vec![];
        for v in views.iter().step_by(step){
            let Place::Air{cell,..}=scene.locate(v.eye()) else{continue};
            let p=v.pinhole(128,128);
            for y in 0..128{for x in 0..128{ rays.push((cell,p.ray(x,y))); }}
        }
        let mut run=|rays:&[(u32,Ray)]|{ n=0.0;c=[0.0;6];
        for (cell,r) in rays{
            let (h,k)=scene.trace_cost_from(Start::Cell(*cell),r,Want::LEAST);
            n+=1.0; c[0]+=k.cells as f64;c[1]+=k.nodes as f64;c[2]+=k.blocks as f64;c[3]+=k.tests as f64;c[4]+=k.unsure as f64;
            if let Answer::Hit(_)=h.answer(){c[5]+=1.0}
        }
        println!("{path} cells {:.2} nodes {:.2} blocks {:.2} tests {:.2} unsure {:.4} hit {:.2}",c[0]/n,c[1]/n,c[2]/n,c[3]/n,c[4]/n,c[5]/n);};
        run(&rays);
        let mut s=12345u64; let mut rnd=||{s=s.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407); (s>>11) as f64/(1u64<<53) as f64};
        let rooms:Vec<_>=scene.rooms().filter(|r|r.is_closed()).map(|r|r.bounds()).collect();
        let mut rs=vec![];
        while rs.len()<100000{ let b=rooms[(rnd()*rooms.len() as f64) as usize]; let p=[0,1,2].map(|i|b[0][i]+(b[1][i]-b[0][i])*rnd());
          if let Place::Air{cell,room:Some(_),..}=scene.locate(p){ let z=2.0*rnd()-1.0; let a=6.283185307*rnd(); let r=(1.0-z*z).sqrt(); rs.push((cell,Ray::new(p,[r*a.cos(),r*a.sin(),z])));}}
        run(&rs);
    }
}
