//! Embree 3 or 4, looked for when the program runs: the library that `EMBREE_LIB` names, or Debian's `libembree3.so.3`.
//!
//! Its C interface is written down here as far as it is used, from `embree3/rtcore.h` and `embree4/rtcore.h`.
#![allow(unsafe_code)]

use std::ffi::{c_char, c_void};
use std::mem::ManuallyDrop;
use std::sync::Arc;

use anyhow::{Context, bail};
use libloading::Library;

use crate::way::{Met, Rays, Single, Way};

type Handle = *mut c_void;

const TRIANGLES: i32 = 0;
const INDICES: i32 = 0;
const VERTICES: i32 = 1;
const UINT3: i32 = 0x5003;
const FLOAT3: i32 = 0x9003;
const ROBUST: i32 = 1 << 2;
const VERSION: i32 = 0;
const NONE: u32 = u32::MAX;

/// `RTCRayHit`: the hit's end is left open, as releases differ in it.
#[derive(Clone, Copy)]
#[repr(C, align(16))]
struct RayHit {
    origin: [f32; 3],
    tnear: f32,
    direction: [f32; 3],
    time: f32,
    tfar: f32,
    mask: u32,
    id: u32,
    flags: u32,
    normal: [f32; 3],
    uv: [f32; 2],
    primitive: u32,
    geometry: u32,
    instances: [u32; 5],
}

impl RayHit {
    #[inline(always)]
    fn new(ray: &Single) -> RayHit {
        RayHit {
            origin: ray.origin,
            tnear: ray.tmin,
            direction: ray.direction,
            time: 0.0,
            tfar: ray.tmax,
            mask: NONE,
            id: 0,
            flags: 0,
            normal: [0.0; 3],
            uv: [0.0; 2],
            primitive: NONE,
            geometry: NONE,
            instances: [NONE; 5],
        }
    }

    #[inline(always)]
    fn met(&self) -> Met {
        if self.geometry == NONE {
            return Met::NOTHING;
        }
        Met { t: f64::from(self.tfar), triangle: self.primitive, padding: 0 }
    }
}

/// `RTCRayHit16`: sixteen of each.
#[repr(C, align(64))]
struct RayHit16 {
    /// Origin, near end, direction, time, far end.
    ray: [[f32; 16]; 9],
    /// Mask, number, flags.
    marks: [[u32; 16]; 3],
    /// Normal, u, v.
    hit: [[f32; 16]; 5],
    primitive: [u32; 16],
    geometry: [u32; 16],
    instances: [[u32; 16]; 2],
}

/// `RTCIntersectContext` of Embree 3.
#[repr(C, align(16))]
struct Context3 {
    flags: i32,
    filter: usize,
    instance: [u32; 8],
}

/// `RTCIntersectArguments` of Embree 4.
#[repr(C, align(16))]
struct Arguments4 {
    flags: i32,
    features: u32,
    context: usize,
    filter: usize,
    intersect: usize,
    more: [usize; 4],
}

/// The functions whose arguments are the same in both.
struct Common {
    new_device: unsafe extern "C" fn(*const c_char) -> Handle,
    property: unsafe extern "C" fn(Handle, i32) -> isize,
    new_scene: unsafe extern "C" fn(Handle) -> Handle,
    scene_quality: unsafe extern "C" fn(Handle, i32),
    scene_flags: unsafe extern "C" fn(Handle, i32),
    new_geometry: unsafe extern "C" fn(Handle, i32) -> Handle,
    geometry_quality: unsafe extern "C" fn(Handle, i32),
    new_buffer: unsafe extern "C" fn(Handle, i32, u32, i32, usize, usize) -> Handle,
    commit_geometry: unsafe extern "C" fn(Handle),
    attach: unsafe extern "C" fn(Handle, Handle) -> u32,
    release_geometry: unsafe extern "C" fn(Handle),
    commit_scene: unsafe extern "C" fn(Handle),
    release_scene: unsafe extern "C" fn(Handle),
    release_device: unsafe extern "C" fn(Handle),
}

type One3 = unsafe extern "C" fn(Handle, *mut Context3, *mut RayHit);
type One4 = unsafe extern "C" fn(Handle, *mut RayHit, *mut Arguments4);
type Sixteen3 = unsafe extern "C" fn(*const i32, Handle, *mut Context3, *mut RayHit16);
type Sixteen4 = unsafe extern "C" fn(*const i32, Handle, *mut RayHit16, *mut Arguments4);
type Stream3 = unsafe extern "C" fn(Handle, *mut Context3, *mut RayHit, u32, usize);

enum Calls {
    Three { one: One3, occluded: One3, sixteen: Sixteen3, stream: Stream3 },
    Four { one: One4, occluded: One4, sixteen: Sixteen4 },
}

/// The library.
pub struct Embree {
    common: Common,
    calls: Calls,
    device: Handle,
    /// Such as `4.4`.
    pub version: String,
    /// Never unloaded: threads of its own may run to the end.
    _library: ManuallyDrop<Library>,
}

// SAFETY: Embree's devices may be used from any thread.
unsafe impl Send for Embree {}
// SAFETY: as above.
unsafe impl Sync for Embree {}

impl Drop for Embree {
    fn drop(&mut self) {
        // SAFETY: the device is no longer used: every scene holds an `Arc` of this.
        unsafe { (self.common.release_device)(self.device) }
    }
}

impl Embree {
    /// # Errors
    /// If the library cannot be found, or is not Embree 3 or 4.
    pub fn load() -> anyhow::Result<Arc<Embree>> {
        let name = std::env::var("EMBREE_LIB").unwrap_or_else(|_| "libembree3.so.3".to_owned());
        // SAFETY: the user names a library of Embree; loading it runs its own set-up only.
        let library = unsafe { Library::new(&name) }.with_context(|| format!("loading {name}"))?;
        macro_rules! get {
            ($symbol:literal) => {
                // SAFETY: the field that it goes to has the type that Embree's header gives.
                *unsafe { library.get($symbol) }
                    .with_context(|| format!("{name} lacks {}", String::from_utf8_lossy($symbol)))?
            };
        }
        let common = Common {
            new_device: get!(b"rtcNewDevice"),
            property: get!(b"rtcGetDeviceProperty"),
            new_scene: get!(b"rtcNewScene"),
            scene_quality: get!(b"rtcSetSceneBuildQuality"),
            scene_flags: get!(b"rtcSetSceneFlags"),
            new_geometry: get!(b"rtcNewGeometry"),
            geometry_quality: get!(b"rtcSetGeometryBuildQuality"),
            new_buffer: get!(b"rtcSetNewGeometryBuffer"),
            commit_geometry: get!(b"rtcCommitGeometry"),
            attach: get!(b"rtcAttachGeometry"),
            release_geometry: get!(b"rtcReleaseGeometry"),
            commit_scene: get!(b"rtcCommitScene"),
            release_scene: get!(b"rtcReleaseScene"),
            release_device: get!(b"rtcReleaseDevice"),
        };
        // SAFETY: a string that ends with zero; the device is released when this is dropped.
        let device = unsafe { (common.new_device)(c"threads=1".as_ptr()) };
        if device.is_null() {
            bail!("{name} makes no device");
        }
        // SAFETY: the device is one.
        let version = unsafe { (common.property)(device, VERSION) };
        let calls = match version / 10000 {
            3 => Calls::Three {
                one: get!(b"rtcIntersect1"),
                occluded: get!(b"rtcOccluded1"),
                sixteen: get!(b"rtcIntersect16"),
                stream: get!(b"rtcIntersect1M"),
            },
            4 => Calls::Four {
                one: get!(b"rtcIntersect1"),
                occluded: get!(b"rtcOccluded1"),
                sixteen: get!(b"rtcIntersect16"),
            },
            other => bail!("{name} is Embree {other}; 3 and 4 are known"),
        };
        let version = format!("{}.{}.{}", version / 10000, version / 100 % 100, version % 100);
        Ok(Arc::new(Embree { common, calls, device, version, _library: ManuallyDrop::new(library) }))
    }
}

/// How carefully the hierarchy is built.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quality {
    Medium = 1,
    High = 2,
}

/// A scene built by Embree.
pub struct Built {
    embree: Arc<Embree>,
    scene: Handle,
    label: String,
}

// SAFETY: committed scenes are only read, from any thread.
unsafe impl Send for Built {}
// SAFETY: as above.
unsafe impl Sync for Built {}

impl Drop for Built {
    fn drop(&mut self) {
        // SAFETY: nothing else holds the scene.
        unsafe { (self.embree.common.release_scene)(self.scene) }
    }
}

impl Built {
    pub fn new(embree: &Arc<Embree>, soup: &[[[f32; 3]; 3]], quality: Quality, robust: bool) -> Built {
        let c = &embree.common;
        // SAFETY: handles are used as the header says; the buffers have room for as many items as are written, and Embree pads
        // them itself.
        let scene = unsafe {
            let scene = (c.new_scene)(embree.device);
            (c.scene_quality)(scene, quality as i32);
            (c.scene_flags)(scene, if robust { ROBUST } else { 0 });
            let geometry = (c.new_geometry)(embree.device, TRIANGLES);
            (c.geometry_quality)(geometry, quality as i32);
            let vertices = (c.new_buffer)(geometry, VERTICES, 0, FLOAT3, 12, 3 * soup.len());
            std::slice::from_raw_parts_mut(vertices.cast::<[[f32; 3]; 3]>(), soup.len())
                .copy_from_slice(soup);
            let indices = (c.new_buffer)(geometry, INDICES, 0, UINT3, 12, soup.len());
            let indices = std::slice::from_raw_parts_mut(indices.cast::<[u32; 3]>(), soup.len());
            for (triangle, item) in indices.iter_mut().enumerate() {
                *item = [0, 1, 2].map(|i| 3 * triangle as u32 + i);
            }
            (c.commit_geometry)(geometry);
            (c.attach)(scene, geometry);
            (c.release_geometry)(geometry);
            (c.commit_scene)(scene);
            scene
        };
        let quality = format!("{quality:?}").to_lowercase();
        let label = format!("Embree {}, {quality}{}", embree.version, if robust { ", robust" } else { "" });
        Built { embree: Arc::clone(embree), scene, label }
    }

    fn context(coherent: bool) -> Context3 {
        Context3 { flags: i32::from(coherent), filter: 0, instance: [NONE; 8] }
    }

    fn arguments(coherent: bool) -> Arguments4 {
        let flags = if coherent { 1 << 16 } else { 0 };
        Arguments4 { flags, features: NONE, context: 0, filter: 0, intersect: 0, more: [0; 4] }
    }
}

/// `rtcIntersect1` and `rtcOccluded1`.
pub struct One(pub Arc<Built>);

impl Way for One {
    fn name(&self) -> String {
        self.0.label.clone()
    }

    fn nearest(&self, rays: &Rays, met: &mut [Met]) {
        let (mut context, mut arguments) = (Built::context(false), Built::arguments(false));
        for (single, met) in rays.singles.iter().zip(met) {
            let mut ray = RayHit::new(single);
            // SAFETY: the scene is committed, and the records are as long and as aligned as Embree's.
            unsafe {
                match self.0.embree.calls {
                    Calls::Three { one, .. } => one(self.0.scene, &mut context, &mut ray),
                    Calls::Four { one, .. } => one(self.0.scene, &mut ray, &mut arguments),
                }
            }
            *met = ray.met();
        }
    }

    fn occluded(&self, rays: &Rays, answers: &mut [bool]) -> bool {
        let (mut context, mut arguments) = (Built::context(false), Built::arguments(false));
        for (single, answer) in rays.singles.iter().zip(answers) {
            let mut ray = RayHit::new(single);
            // SAFETY: as above; a ray with a hit is longer than the ray that is asked for.
            unsafe {
                match self.0.embree.calls {
                    Calls::Three { occluded, .. } => occluded(self.0.scene, &mut context, &mut ray),
                    Calls::Four { occluded, .. } => occluded(self.0.scene, &mut ray, &mut arguments),
                }
            }
            *answer = ray.tfar == f32::NEG_INFINITY;
        }
        true
    }
}

/// `rtcIntersect16`: rays that follow each other as one packet.
pub struct Sixteen {
    pub built: Arc<Built>,
    /// Whether Embree is told that the rays of a packet run together.
    pub coherent: bool,
}

impl Way for Sixteen {
    fn name(&self) -> String {
        let rays = if self.coherent { "coherent 16-packets" } else { "16-packets" };
        format!("{}, {rays}", self.built.label)
    }

    fn nearest(&self, rays: &Rays, met: &mut [Met]) {
        let (mut context, mut arguments) = (Built::context(self.coherent), Built::arguments(self.coherent));
        for (singles, met) in rays.singles.chunks(16).zip(met.chunks_mut(16)) {
            #[repr(align(64))]
            struct Valid([i32; 16]);
            let mut valid = Valid([0; 16]);
            let mut packet = RayHit16 {
                ray: [[0.0; 16]; 9],
                marks: [[NONE; 16], [0; 16], [0; 16]],
                hit: [[0.0; 16]; 5],
                primitive: [NONE; 16],
                geometry: [NONE; 16],
                instances: [[NONE; 16]; 2],
            };
            for (i, single) in singles.iter().enumerate() {
                valid.0[i] = -1;
                for axis in 0..3 {
                    packet.ray[axis][i] = single.origin[axis];
                    packet.ray[4 + axis][i] = single.direction[axis];
                }
                (packet.ray[3][i], packet.ray[8][i]) = (single.tmin, single.tmax);
            }
            // SAFETY: the scene is committed, and the records are as long and as aligned as Embree's.
            unsafe {
                match self.built.embree.calls {
                    Calls::Three { sixteen, .. } => {
                        sixteen(valid.0.as_ptr(), self.built.scene, &mut context, &mut packet);
                    }
                    Calls::Four { sixteen, .. } => {
                        sixteen(valid.0.as_ptr(), self.built.scene, &mut packet, &mut arguments);
                    }
                }
            }
            for (i, met) in met.iter_mut().enumerate() {
                let is_hit = packet.geometry[i] != NONE;
                let t = f64::from(packet.ray[8][i]);
                *met =
                    if is_hit { Met { t, triangle: packet.primitive[i], padding: 0 } } else { Met::NOTHING };
            }
        }
    }
}

/// `rtcIntersect1M`, which Embree 3 has: streams of rays, told to run together.
pub struct Stream(pub Arc<Built>);

impl Stream {
    /// None for Embree 4, which has no streams.
    pub fn new(built: &Arc<Built>) -> Option<Stream> {
        matches!(built.embree.calls, Calls::Three { .. }).then(|| Stream(Arc::clone(built)))
    }
}

impl Way for Stream {
    fn name(&self) -> String {
        format!("{}, stream", self.0.label)
    }

    fn nearest(&self, rays: &Rays, met: &mut [Met]) {
        /// Rays in a stream: as many as stay in the first cache.
        const LENGTH: usize = 128;
        let mut context = Built::context(true);
        let Calls::Three { stream, .. } = self.0.embree.calls else { return };
        let mut records = Vec::with_capacity(LENGTH);
        for (singles, met) in rays.singles.chunks(LENGTH).zip(met.chunks_mut(LENGTH)) {
            records.clear();
            records.extend(singles.iter().map(RayHit::new));
            // SAFETY: as many records as are said, each as long and as aligned as Embree's.
            unsafe {
                let stride = size_of::<RayHit>();
                stream(self.0.scene, &mut context, records.as_mut_ptr(), records.len() as u32, stride);
            }
            for (record, met) in records.iter().zip(met) {
                *met = record.met();
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn records_are_as_long_as_embrees() {
        assert_eq!(size_of::<RayHit>(), 96);
        assert_eq!(std::mem::offset_of!(RayHit, primitive), 68);
        assert_eq!(size_of::<RayHit16>(), 64 * 21);
        assert_eq!(std::mem::offset_of!(RayHit16, primitive), 64 * 17);
    }
}
