//! The building in a scene's file: sections `map` and after (docs/FORMAT.md).

use enfilade_importers::{ElementId, MaterialId};

use super::{Building, Element, Face, FaceKind, Volume};
use crate::format::map::{
    DartRecord, MapFaceRecord, MapRecord, MapSourceRecord, MapTriangle, MapVolumeRecord,
};
use crate::format::{FormatError, MapTables, MapViews};
use crate::gmap::GMap;
use crate::lattice::{Lattice, Plane, Point};
use crate::partition::cells::{Label, NONE, Source};
use crate::scene::Scene;
use crate::sew::{Sewn, Topology, Way};

impl Building {
    /// The building as sections of a file.
    pub(crate) fn to_tables(&self) -> MapTables {
        let map = &self.topology.map;
        let (joined, longest) = self.topology.joined;
        let dart = |index: usize| {
            let alpha = map.dart(index).map(|dart| [0, 1, 2, 3].map(|i| map.alpha(i, dart).index() as u32));
            DartRecord {
                alpha: alpha.unwrap_or([NONE; 4]),
                vertex: self.topology.vertex_of[index],
                volume: self.topology.cell_of[index],
            }
        };
        let triangle = |&(element, triangle): &(ElementId, u32)| -> MapTriangle { [element.0, triangle] };
        let mut tables = MapTables {
            map: vec![MapRecord { hull: self.hull, joined, longest }],
            darts: (0..map.table_len()).map(dart).collect(),
            mapvertices: self.topology.points.clone(),
            mapvolumes: self.volumes.iter().map(volume_record).collect(),
            mapcorners: self.footprints.iter().map(|p| [p.x, p.y]).collect(),
            mapplanes: self.planes.iter().map(|plane| [plane.p, plane.q, plane.r]).collect(),
            mapfaces: self.topology.faces.iter().zip(&self.faces).map(|(s, f)| face_record(s, f)).collect(),
            mapsources: Vec::with_capacity(self.sources.len()),
            maptriangles: Vec::new(),
            mapdetail: self.detail.iter().map(triangle).collect(),
        };
        for source in &self.sources {
            tables.mapsources.push(MapSourceRecord {
                first: tables.maptriangles.len() as u32,
                count: source.triangles.len() as u32,
                plane: source.plane.unwrap_or(NONE),
            });
            tables.maptriangles.extend(source.triangles.iter().map(triangle));
        }
        tables
    }
}

fn volume_record(volume: &Volume) -> MapVolumeRecord {
    let (kind, element) = match volume.label {
        Label::Solid(element) => (MapVolumeRecord::SOLID, element.0),
        Label::Air(element) => (MapVolumeRecord::AIR, element.0),
        Label::Exterior => (MapVolumeRecord::EXTERIOR, NONE),
        Label::Void => (MapVolumeRecord::VOID, NONE),
    };
    MapVolumeRecord {
        kind,
        element,
        floor: volume.floor,
        ceiling: volume.ceiling,
        first_corner: volume.footprint.start,
        corners: volume.footprint.end - volume.footprint.start,
        dart: volume.dart.index() as u32,
        reserved: 0,
    }
}

fn face_record(sewn: &Sewn, face: &Face) -> MapFaceRecord {
    let (way, place) = match sewn.way {
        // Planes are fewer than lattice points.
        Way::Ceiling(plane) => (MapFaceRecord::CEILING, [plane as i32, 0, 0, 0]),
        Way::Floor(plane) => (MapFaceRecord::FLOOR, [plane as i32, 0, 0, 0]),
        Way::Upright([a, b]) => (MapFaceRecord::UPRIGHT, [a.x, a.y, b.x, b.y]),
    };
    MapFaceRecord {
        area: face.area,
        one: sewn.one,
        other: sewn.other,
        dart: sewn.dart.index() as u32,
        way,
        place,
        sources: sewn.sources,
        kind: face.kind.number(),
        element: face.element.map_or(NONE, |element| element.0),
        material: face.material.map_or(NONE, |material| material.0),
        reserved: 0,
    }
}

impl Scene {
    /// The building that the scene was compiled from, as it was then; `None` if its map was not kept
    /// ([`CompileOptions::topology`](crate::CompileOptions::topology)).
    ///
    /// The map of a file that someone else wrote may be none of a building:
    /// [`validate`](crate::validate::validate) tells.
    ///
    /// # Errors
    /// [`FormatError`] if the map's sections are damaged: rays do not need them, and opening a file does not read them.
    pub fn building(&self) -> Result<Option<Building>, FormatError> {
        self.tables.check_map()?;
        Ok(self.tables.map.as_ref().and_then(|map| self.building_of(map)))
    }

    fn building_of(&self, map: &MapViews) -> Option<Building> {
        let scene = &self.tables.scene[0];
        let optional = |index: u32| (index != NONE).then_some(index);
        let gmap = GMap::from_alphas(map.darts.iter().map(|dart| dart.alpha));
        let dart = |index: u32| gmap.dart(index as usize);
        let sewn = map.mapfaces.iter().map(|face| {
            let [a, b, c, d] = face.place;
            let way = match face.way {
                MapFaceRecord::CEILING => Way::Ceiling(a as u32),
                MapFaceRecord::FLOOR => Way::Floor(a as u32),
                _ => Way::Upright([Point::new(a, b), Point::new(c, d)]),
            };
            Some(Sewn {
                one: face.one,
                other: face.other,
                dart: dart(face.dart)?,
                way,
                sources: face.sources,
            })
        });
        let faces = map.mapfaces.iter().map(|face| {
            Some(Face {
                kind: FaceKind::from_number(face.kind)?,
                element: optional(face.element).map(ElementId),
                material: optional(face.material).map(MaterialId),
                area: face.area,
            })
        });
        let volumes = map.mapvolumes.iter().map(|volume| {
            let element = ElementId(volume.element);
            let label = match volume.kind {
                MapVolumeRecord::SOLID => Label::Solid(element),
                MapVolumeRecord::AIR => Label::Air(element),
                MapVolumeRecord::EXTERIOR => Label::Exterior,
                _ => Label::Void,
            };
            let footprint = volume.first_corner..volume.first_corner + volume.corners;
            let (floor, ceiling) = (volume.floor, volume.ceiling);
            Some(Volume { label, floor, ceiling, footprint, dart: dart(volume.dart)? })
        });
        let triangle = |&[element, triangle]: &MapTriangle| (ElementId(element), triangle);
        let sources = map.mapsources.iter().map(|source| Source {
            triangles: map.maptriangles[source.first as usize..][..source.count as usize]
                .iter()
                .map(triangle)
                .collect(),
            plane: optional(source.plane),
        });
        let elements = self.elements().map(|element| Element {
            id: element.id().to_owned(),
            name: element.name().to_owned(),
            path: element.path().to_owned(),
            semantic: element.semantic(),
            storey: Some(element.storey()).filter(|storey| !storey.is_empty()).map(str::to_owned),
            host: element.host().map(ElementId),
            filling: element.filling().map(ElementId),
        });
        let record = map.map.first()?;
        // That all darts and numbers are there was checked.
        let (sewn, faces) = (sewn.collect::<Option<_>>()?, faces.collect::<Option<_>>()?);
        let mut building = Building {
            lattice: Lattice {
                origin: scene.lattice_origin,
                turn: scene.lattice_turn,
                bits: scene.lattice_bits,
            },
            hull: record.hull,
            planes: map.mapplanes.iter().map(|&[p, q, r]| Plane { p, q, r }).collect(),
            volumes: volumes.collect::<Option<_>>()?,
            footprints: map.mapcorners.iter().map(|&[x, y]| Point::new(x, y)).collect(),
            faces,
            sources: sources.collect(),
            detail: map.mapdetail.iter().map(triangle).collect(),
            elements: elements.collect(),
            labels: Default::default(),
            topology: Topology {
                faces: sewn,
                vertex_of: map.darts.iter().map(|dart| dart.vertex).collect(),
                cell_of: map.darts.iter().map(|dart| dart.volume).collect(),
                points: map.mapvertices.to_vec(),
                joined: (record.joined, record.longest),
                map: gmap,
            },
        };
        building.labels = building.gathered();
        Some(building)
    }

    /// Whether the scene's file holds the building's map.
    pub fn has_building(&self) -> bool {
        self.tables.map.is_some()
    }
}
