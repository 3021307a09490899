//! KHR_lights_punctual and cameras.

use std::f32::consts::{FRAC_PI_2, FRAC_PI_4};

use gltf::json;
use gltf::json::extensions::scene::khr_lights_punctual::{Light as LightJson, Type};
use gltf::json::validation::Checked;

use super::graph::Visit;
use super::transform::unit;
use crate::builder::ModelBuilder;
use crate::model::{Camera, LeftOut, LeftOutReason, Light, LightKind};

/// Gives the builder the light and the camera of a visited node, if it has them.
pub(super) fn read(root: &json::Root, visit: &Visit, builder: &mut ModelBuilder) {
    let node = &root.nodes[visit.node];
    let light = node.extensions.as_ref().and_then(|extensions| extensions.khr_lights_punctual.as_ref());
    if let Some(light) = light.and_then(|light| root.get(light.light)) {
        match convert_light(light, visit) {
            Ok(mut light) => {
                light.name = name_of(node, light.name);
                builder.light(light);
            }
            Err(text) => {
                builder.warn(format!("nodes[{}]", visit.node), format!("the light is left out: {text}"))
            }
        }
    }
    if let Some(camera) = node.camera.and_then(|camera| root.get(camera)) {
        match convert_camera(camera, visit) {
            Some(mut camera) => {
                camera.name = name_of(node, camera.name);
                builder.camera(camera);
            }
            None => builder.left_out(LeftOut {
                element: None,
                place: format!("nodes[{}]", visit.node),
                reason: LeftOutReason::Camera,
                count: 1,
            }),
        }
    }
}

/// Tools show a node's name; that of the light or camera that it holds is often made up.
fn name_of(node: &json::Node, own: String) -> String {
    node.name.clone().filter(|name| !name.is_empty()).unwrap_or(own)
}

fn convert_light(light: &LightJson, visit: &Visit) -> Result<Light, &'static str> {
    let Checked::Valid(kind) = light.type_ else { return Err("unknown type") };
    if !light.intensity.is_finite() || light.intensity < 0.0 || light.color.iter().any(|c| !c.is_finite()) {
        return Err("its colour or intensity is no amount of light");
    }
    let kind = match kind {
        Type::Point => LightKind::Point,
        Type::Directional => LightKind::Directional,
        Type::Spot => {
            let (inner, outer) = light
                .spot
                .as_ref()
                .map_or((0.0, FRAC_PI_4), |spot| (spot.inner_cone_angle, spot.outer_cone_angle));
            if !(outer > 0.0 && inner.is_finite()) {
                return Err("its cone has no inside");
            }
            let outer = outer.min(FRAC_PI_2);
            LightKind::Spot { inner: inner.clamp(0.0, outer), outer }
        }
    };
    let direction = unit(visit.world.direction([0.0, 0.0, -1.0]));
    let direction = match (direction, kind) {
        (Some(direction), _) => direction,
        (None, LightKind::Point) => [0.0, 0.0, -1.0],
        (None, _) => return Err("its node has no depth, and so it no direction"),
    };
    let range = light.range.map(f64::from).filter(|range| *range > 0.0).unwrap_or(f64::INFINITY);
    Ok(Light {
        name: light.name.clone().unwrap_or_default(),
        kind,
        position: visit.world.translation,
        direction,
        color: light.color.map(|c| c.clamp(0.0, 1.0)),
        intensity: light.intensity,
        range,
    })
}

/// A pinhole camera; `None` for orthographic ones and those without an inside.
fn convert_camera(camera: &json::Camera, visit: &Visit) -> Option<Camera> {
    let perspective = match camera.type_ {
        Checked::Valid(json::camera::Type::Perspective) => camera.perspective.as_ref()?,
        _ => return None,
    };
    let vfov_degrees = f64::from(perspective.yfov).to_degrees();
    if !(vfov_degrees > 0.0 && vfov_degrees < 180.0) {
        return None;
    }
    let direction = unit(visit.world.direction([0.0, 0.0, -1.0]))?;
    let up = visit.world.direction([0.0, 1.0, 0.0]);
    // A node may be sheared: what leans towards the view is taken off.
    let lean = up[0] * direction[0] + up[1] * direction[1] + up[2] * direction[2];
    let up = unit([0, 1, 2].map(|axis| up[axis] - lean * direction[axis]))?;
    Some(Camera {
        name: camera.name.clone().unwrap_or_default(),
        eye: visit.world.translation,
        direction,
        up,
        vfov_degrees,
    })
}

#[cfg(test)]
mod tests {
    use super::super::testing::{self, GltfText};
    use super::*;
    use crate::model::Model;
    use serde_json::{Value, json};

    fn model_with(node: Value, extra: impl Fn(&mut Value)) -> Model {
        let mut text = GltfText::triangle();
        text.json["nodes"].as_array_mut().unwrap().push(node);
        text.json["scenes"][0]["nodes"] = json!([0, 1]);
        extra(&mut text.json);
        testing::read(&text).unwrap()
    }

    fn light(light: Value) -> Model {
        // A quarter turn about X: -Z becomes -Y... in glTF's axes; then scaled, which does not matter.
        let node = json!({
            "name": "Lampe", "translation": [1, 2, 3], "rotation": [-0.5f64.sqrt(), 0.0, 0.0, 0.5f64.sqrt()],
            "scale": [2, 3, 4], "extensions": { "KHR_lights_punctual": { "light": 0 } }
        });
        model_with(node, |json| json["extensions"] = json!({ "KHR_lights_punctual": { "lights": [light] } }))
    }

    fn near(a: [f64; 3], b: [f64; 3]) -> bool {
        a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-12)
    }

    #[test]
    fn lights_follow_their_nodes() {
        let spot = light(json!({
            "type": "spot", "name": "x", "color": [1.0, 0.5, 0.25], "intensity": 30.0, "range": 7.5,
            "spot": { "innerConeAngle": 0.25, "outerConeAngle": 0.5 }
        }));
        let spot = &spot.lights[0];
        assert_eq!(spot.kind, LightKind::Spot { inner: 0.25, outer: 0.5 });
        assert_eq!((spot.name.as_str(), spot.color, spot.intensity), ("Lampe", [1.0, 0.5, 0.25], 30.0));
        // Internal axes are Z up.
        assert_eq!((spot.position, spot.range), ([1.0, -3.0, 2.0], 7.5));
        assert!(near(spot.direction, [0.0, 0.0, -1.0]), "{:?}", spot.direction);
        assert_eq!(light(json!({ "type": "point" })).lights[0].range, f64::INFINITY);
        assert_eq!(light(json!({ "type": "directional" })).lights[0].kind, LightKind::Directional);
    }

    #[test]
    fn impossible_lights_are_left_out_with_a_warning() {
        let cone = json!({ "innerConeAngle": 0.0, "outerConeAngle": 0.0 });
        for bad in [json!({ "type": "point", "intensity": -1.0 }), json!({ "type": "spot", "spot": cone })] {
            let model = light(bad);
            assert!(model.lights.is_empty());
            assert_eq!(model.warnings[0].place, "nodes[1]");
        }
    }

    #[test]
    fn cameras_look_down_minus_z() {
        let node = json!({ "name": "View", "translation": [0, 1.6, 5], "scale": [1, 2, 2], "camera": 0 });
        let model = model_with(node, |json| {
            json["cameras"] = json!([{
                "type": "perspective", "perspective": { "yfov": std::f64::consts::FRAC_PI_3, "znear": 0.1 }
            }]);
        });
        let camera = &model.cameras[0];
        assert_eq!((camera.name.as_str(), camera.eye), ("View", [0.0, -5.0, 1.6]));
        assert!(near(camera.direction, [0.0, 1.0, 0.0]) && near(camera.up, [0.0, 0.0, 1.0]));
        assert!((camera.vfov_degrees - 60.0).abs() < 1e-5);
    }

    #[test]
    fn orthographic_cameras_are_left_out() {
        let model = model_with(json!({ "camera": 0 }), |json| {
            json["cameras"] = json!([{
                "type": "orthographic", "orthographic": { "xmag": 1, "ymag": 1, "zfar": 10, "znear": 0.1 }
            }]);
        });
        assert!(model.cameras.is_empty());
        assert_eq!((model.left_out[0].reason, model.left_out[0].count), (LeftOutReason::Camera, 1));
    }
}
