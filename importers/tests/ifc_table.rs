//! The shipped table: every class of the IFC schemas that can have geometry gets a meaning, and the right one.
#![cfg(feature = "rules")]

use enfilade_importers::tagging::{Rules, describe, tag};
use enfilade_importers::{
    Element, Frame, ImportOptions, Material, ModelBuilder, NewElement, Role, Semantic, TagSource,
};

/// All subtypes of IfcProduct in IFC2x3 TC1 that are not abstract.
const IFC2X3: &str = "
    IfcAnnotation IfcBeam IfcBuilding IfcBuildingElementPart IfcBuildingElementProxy IfcBuildingStorey
    IfcChamferEdgeFeature IfcColumn IfcCovering IfcCurtainWall IfcDiscreteAccessory
    IfcDistributionChamberElement IfcDistributionControlElement IfcDistributionElement
    IfcDistributionFlowElement IfcDistributionPort IfcDoor IfcElectricDistributionPoint IfcElectricalElement
    IfcElementAssembly IfcEnergyConversionDevice IfcEquipmentElement IfcFastener IfcFlowController
    IfcFlowFitting IfcFlowMovingDevice IfcFlowSegment IfcFlowStorageDevice IfcFlowTerminal
    IfcFlowTreatmentDevice IfcFooting IfcFurnishingElement IfcGrid IfcMechanicalFastener IfcMember
    IfcOpeningElement IfcPile IfcPlate IfcProjectionElement IfcProxy IfcRailing IfcRamp IfcRampFlight
    IfcReinforcingBar IfcReinforcingMesh IfcRoof IfcRoundedEdgeFeature IfcSite IfcSlab IfcSpace IfcStair
    IfcStairFlight IfcStructuralCurveConnection IfcStructuralCurveMember IfcStructuralCurveMemberVarying
    IfcStructuralLinearAction IfcStructuralLinearActionVarying IfcStructuralPlanarAction
    IfcStructuralPlanarActionVarying IfcStructuralPointAction IfcStructuralPointConnection
    IfcStructuralPointReaction IfcStructuralSurfaceConnection IfcStructuralSurfaceMember
    IfcStructuralSurfaceMemberVarying IfcTendon IfcTendonAnchor IfcTransportElement IfcVirtualElement IfcWall
    IfcWallStandardCase IfcWindow";

/// Those that IFC4 added.
const IFC4: &str = "
    IfcActuator IfcAirTerminal IfcAirTerminalBox IfcAirToAirHeatRecovery IfcAlarm IfcAudioVisualAppliance
    IfcBeamStandardCase IfcBoiler IfcBurner IfcCableCarrierFitting IfcCableCarrierSegment IfcCableFitting
    IfcCableSegment IfcChiller IfcChimney IfcCivilElement IfcCoil IfcColumnStandardCase
    IfcCommunicationsAppliance IfcCompressor IfcCondenser IfcController IfcCooledBeam IfcCoolingTower
    IfcDamper IfcDoorStandardCase IfcDuctFitting IfcDuctSegment IfcDuctSilencer IfcElectricAppliance
    IfcElectricDistributionBoard IfcElectricFlowStorageDevice IfcElectricGenerator IfcElectricMotor
    IfcElectricTimeControl IfcEngine IfcEvaporativeCooler IfcEvaporator IfcExternalSpatialElement IfcFan
    IfcFilter IfcFireSuppressionTerminal IfcFlowInstrument IfcFlowMeter IfcFurniture IfcGeographicElement
    IfcHeatExchanger IfcHumidifier IfcInterceptor IfcJunctionBox IfcLamp IfcLightFixture IfcMedicalDevice
    IfcMemberStandardCase IfcMotorConnection IfcOpeningStandardCase IfcOutlet IfcPipeFitting IfcPipeSegment
    IfcPlateStandardCase IfcProtectiveDevice IfcProtectiveDeviceTrippingUnit IfcPump IfcSanitaryTerminal
    IfcSensor IfcShadingDevice IfcSlabElementedCase IfcSlabStandardCase IfcSolarDevice IfcSpaceHeater
    IfcSpatialZone IfcStackTerminal IfcStructuralCurveAction IfcStructuralCurveReaction
    IfcStructuralSurfaceAction IfcStructuralSurfaceReaction IfcSurfaceFeature IfcSwitchingDevice
    IfcSystemFurnitureElement IfcTank IfcTransformer IfcTubeBundle IfcUnitaryControlElement
    IfcUnitaryEquipment IfcValve IfcVibrationIsolator IfcVoidingFeature IfcWallElementedCase IfcWasteTerminal
    IfcWindowStandardCase";

/// Those that IFC4x3 ADD2 added.
const IFC4X3: &str = "
    IfcAlignment IfcAlignmentCant IfcAlignmentHorizontal IfcAlignmentSegment IfcAlignmentVertical IfcBearing
    IfcBorehole IfcBridge IfcBridgePart IfcBuiltElement IfcCaissonFoundation IfcConveyorSegment IfcCourse
    IfcDeepFoundation IfcDistributionBoard IfcEarthworksCut IfcEarthworksElement IfcEarthworksFill
    IfcElectricFlowTreatmentDevice IfcFacility IfcFacilityPartCommon IfcGeomodel IfcGeoslice
    IfcGeotechnicalStratum IfcImpactProtectionDevice IfcKerb IfcLinearElement IfcLinearPositioningElement
    IfcLiquidTerminal IfcMarineFacility IfcMarinePart IfcMobileTelecommunicationsAppliance IfcMooringDevice
    IfcNavigationElement IfcPavement IfcRail IfcRailway IfcRailwayPart IfcReferent IfcReinforcedSoil IfcRoad
    IfcRoadPart IfcSign IfcSignal IfcTendonConduit IfcTrackElement IfcVehicle IfcVibrationDamper";

/// Those that only hold others: they get no meaning.
const CONTAINERS: &str = "
    IfcBuilding IfcBuildingStorey IfcFacility IfcBridge IfcBridgePart IfcFacilityPartCommon IfcMarineFacility
    IfcMarinePart IfcRailway IfcRailwayPart IfcRoad IfcRoadPart";

/// A class, a name, a material's name, and metadata.
type Given<'a> = (&'a str, &'a str, &'a str, &'a [(&'a str, &'a str)]);

/// These elements, tagged together.
fn tagged(elements: &[Given<'_>]) -> Vec<Element> {
    let mut builder = ModelBuilder::new("test", Frame::default());
    for (index, (class, name, material, extras)) in elements.iter().enumerate() {
        let material = builder.material(Material { name: (*material).into(), ..Material::default() });
        let element = builder
            .element(NewElement {
                id: format!("id{index}"),
                name: (*name).into(),
                source_name: format!("{class}:{name}"),
                class: Some((*class).into()),
                extras: extras.iter().map(|(k, v)| ((*k).to_owned(), (*v).to_owned())).collect(),
                ..NewElement::default()
            })
            .unwrap();
        builder.triangle(element, [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], material).unwrap();
    }
    let mut model = builder.finish().unwrap();
    tag(&mut model, &ImportOptions::default()).unwrap();
    model.elements
}

/// What elements of these classes are, that have nothing else to tell.
fn plain<'c>(classes: impl Iterator<Item = &'c str>) -> Vec<(&'c str, Element)> {
    let classes: Vec<&str> = classes.collect();
    let elements: Vec<_> = classes.iter().map(|class| (*class, "x", "", &[][..])).collect();
    classes.into_iter().zip(tagged(&elements)).collect()
}

fn all_classes() -> impl Iterator<Item = &'static str> {
    [IFC2X3, IFC4, IFC4X3].into_iter().flat_map(str::split_whitespace)
}

#[test]
fn every_class_with_geometry_has_a_meaning() {
    assert_eq!(all_classes().count(), 72 + 90 + 48);
    let spellings: Vec<[String; 3]> =
        all_classes().map(|c| [c.to_owned(), c.to_ascii_uppercase(), c.to_ascii_lowercase()]).collect();
    for (class, element) in plain(spellings.iter().flatten().map(String::as_str)) {
        if CONTAINERS.split_whitespace().any(|c| c.eq_ignore_ascii_case(class)) {
            assert_eq!(
                (element.semantic, element.tagged_by),
                (Semantic::Unknown, TagSource::None),
                "{class}"
            );
        } else {
            assert_ne!(element.semantic, Semantic::Unknown, "{class}");
            assert!(matches!(element.tagged_by, TagSource::Class(_)), "{class}");
            assert_eq!(describe(&element, None), format!("class {class}"));
        }
    }
    // No stale name stays in the table unseen: what it names beyond the schemas are abstract classes and zones.
    let listed: Vec<&str> = all_classes().collect();
    let mut others: Vec<&str> = Rules::shipped_text()
        .lines()
        .filter(|line| !line.starts_with('#'))
        .flat_map(|line| line.split(|c: char| !c.is_ascii_alphanumeric()))
        .filter(|word| word.starts_with("Ifc") && word.len() > 3 && !listed.contains(word))
        .collect();
    others.sort_unstable();
    others.dedup();
    assert_eq!(
        others,
        [
            "IfcBuildingElement",
            "IfcBuildingElementComponent",
            "IfcEdgeFeature",
            "IfcElementComponent",
            "IfcGeotechnicalAssembly",
            "IfcGeotechnicalElement",
            "IfcPort",
            "IfcPositioningElement",
            "IfcReinforcingElement",
            "IfcTransportationDevice",
            "IfcZone",
        ]
    );
}

#[test]
fn classes_mean_what_they_should() {
    let expected = [
        (Semantic::Room, "IfcSpace"),
        (Semantic::Exterior, "IfcExternalSpatialElement"),
        (Semantic::Opening, "IfcOpeningElement IfcOpeningStandardCase IfcVoidingFeature"),
        (Semantic::DoorLeaf, "IfcDoor IfcDoorStandardCase"),
        (Semantic::WindowFrame, "IfcWindow IfcWindowStandardCase"),
        (Semantic::Wall, "IfcWall IfcWallStandardCase IfcWallElementedCase IfcProjectionElement IfcChimney"),
        (Semantic::Ground, "IfcSlab IfcSlabStandardCase IfcSlabElementedCase IfcFooting"),
        (Semantic::Roof, "IfcRoof"),
        (Semantic::Column, "IfcColumn IfcColumnStandardCase IfcPile IfcDeepFoundation IfcCaissonFoundation"),
        (Semantic::Beam, "IfcBeam IfcBeamStandardCase IfcMember IfcMemberStandardCase"),
        (Semantic::Glass, "IfcCurtainWall"),
        (Semantic::Covering, "IfcPlate IfcPlateStandardCase IfcCovering IfcShadingDevice"),
        (Semantic::Stair, "IfcStair IfcStairFlight IfcRamp IfcRampFlight"),
        (Semantic::Railing, "IfcRailing"),
        (Semantic::Furniture, "IfcFurnishingElement IfcFurniture IfcSystemFurnitureElement"),
        (
            Semantic::Equipment,
            "IfcFlowTerminal IfcSanitaryTerminal IfcLightFixture IfcPipeSegment IfcTransportElement",
        ),
        (Semantic::Site, "IfcSite IfcGeographicElement IfcCivilElement IfcPavement IfcEarthworksFill"),
        (
            Semantic::Other,
            "IfcBuildingElementProxy IfcProxy IfcBuildingElementPart IfcElementAssembly IfcReinforcingBar",
        ),
        (Semantic::Other, "IfcTendon IfcFastener IfcMechanicalFastener IfcDiscreteAccessory"),
        (
            Semantic::Annotation,
            "IfcAnnotation IfcGrid IfcVirtualElement IfcZone IfcSpatialZone IfcSurfaceFeature",
        ),
        (
            Semantic::Annotation,
            "IfcDistributionPort IfcStructuralCurveMember IfcStructuralSurfaceAction IfcAlignment",
        ),
    ];
    for (semantic, classes) in expected {
        for (class, element) in plain(classes.split_whitespace()) {
            assert_eq!(element.semantic, semantic, "{class}");
        }
    }
}

#[test]
fn only_these_classes_cut_or_label_space() {
    // The roles that change the partition are few, and chosen by hand: a new class must not slip in.
    let is_case = |class: &str| class.ends_with("StandardCase") || class.ends_with("ElementedCase");
    let tagged = plain(all_classes().filter(|class| !is_case(class)));
    let of = |role: Role| -> Vec<&str> {
        tagged.iter().filter(|(_, element)| element.semantic.role() == Some(role)).map(|row| row.0).collect()
    };
    assert_eq!(
        of(Role::Air),
        ["IfcOpeningElement", "IfcSpace", "IfcExternalSpatialElement", "IfcVoidingFeature"]
    );
    assert_eq!(
        of(Role::Solid),
        [
            "IfcBeam",
            "IfcColumn",
            "IfcFooting",
            "IfcMember",
            "IfcPile",
            "IfcProjectionElement",
            "IfcRoof",
            "IfcSlab",
            "IfcWall",
            "IfcChimney",
            "IfcCaissonFoundation",
            "IfcDeepFoundation",
        ]
    );
}

#[test]
fn metadata_and_names_refine_the_class() {
    type Case = (&'static str, &'static str, &'static str, &'static [(&'static str, &'static str)], Semantic);
    let cases: &[Case] = &[
        ("IfcSpace", "101", "", &[("interior_or_exterior", "INTERNAL")], Semantic::Room),
        ("IfcSpace", "Balcony", "", &[("interior_or_exterior", "EXTERNAL")], Semantic::Exterior),
        ("IfcSpace", "Balcony", "", &[("predefined_type", "EXTERNAL")], Semantic::Exterior),
        ("IfcSpace", "Balcony", "", &[("is_external", "true")], Semantic::Exterior),
        ("IfcSpace", "Kitchen", "", &[("is_external", "false")], Semantic::Room),
        ("IfcSpace", "Gross", "", &[("predefined_type", "GFA")], Semantic::Annotation),
        ("IfcSlab", "x", "", &[("predefined_type", "FLOOR")], Semantic::Ground),
        ("IfcSlab", "x", "", &[("predefined_type", "ROOF")], Semantic::Roof),
        ("IfcSlab", "x", "", &[("predefined_type", "LANDING")], Semantic::Stair),
        ("IfcSlab", "x", "", &[("aggregate_class", "IfcRoof")], Semantic::Roof),
        ("IfcSlab", "Stair:Concrete:1", "", &[], Semantic::Stair),
        ("IfcSlab", "Staircase floor", "", &[], Semantic::Ground),
        ("IfcSlab", "Basic Roof:Wood", "", &[], Semantic::Roof),
        ("IfcSlab", "Flachdach 3", "", &[("predefined_type", "NOTDEFINED")], Semantic::Roof),
        ("IfcSlab", "Roof terrace", "", &[("predefined_type", "FLOOR")], Semantic::Ground),
        ("IfcSlab", "Proof of concept", "", &[], Semantic::Ground),
        ("IfcMember", "x", "", &[("object_type", "stringer")], Semantic::Stair),
        ("IfcMember", "x", "", &[("predefined_type", "MULLION")], Semantic::WindowFrame),
        ("IfcMember", "Rectangular Mullion:50 x 150", "", &[], Semantic::WindowFrame),
        ("IfcMember", "x", "", &[("predefined_type", "BRACE")], Semantic::Beam),
        ("IfcBuildingElementPart", "x", "", &[("aggregate_class", "IfcWall")], Semantic::Wall),
        ("IfcBuildingElementPart", "x", "", &[("aggregate_class", "IfcSlab")], Semantic::Ground),
        ("IfcPlate", "System Panel:Glazed:1", "", &[], Semantic::Glass),
        ("IfcPlate", "x", "Isolierglas 24mm", &[], Semantic::Glass),
        ("IfcPlate", "x", "Clear_Glass", &[], Semantic::Glass),
        ("IfcPlate", "x", "Panneau vitré", &[], Semantic::Glass),
        ("IfcPlate", "System Panel:Solid", "Glaswolle", &[], Semantic::Covering),
        ("IfcPlate", "Glasgow depot", "Steel", &[], Semantic::Covering),
        ("IfcCovering", "x", "", &[("predefined_type", "CEILING")], Semantic::Ceiling),
        ("IfcCovering", "x", "", &[("predefined_type", "FLOORING")], Semantic::Ground),
        ("IfcCovering", "Ceiling trim", "", &[("predefined_type", "CLADDING")], Semantic::Covering),
        ("IfcCovering", "x", "", &[("predefined_type", "ROOFING")], Semantic::Covering),
        ("IfcCovering", "Compound Ceiling:Gypsum", "", &[], Semantic::Ceiling),
        ("IfcCovering", "ACT 600 x 600", "", &[], Semantic::Ceiling),
        ("IfcCovering", "Impact board", "", &[], Semantic::Covering),
        ("IfcCovering", "Abgehängte Decke", "", &[], Semantic::Ceiling),
        ("IfcCovering", "Deckel", "", &[], Semantic::Covering),
        ("IfcCovering", "Faux plafond", "", &[("predefined_type", "NOTDEFINED")], Semantic::Ceiling),
    ];
    let elements: Vec<_> =
        cases.iter().map(|(class, name, material, extras, _)| (*class, *name, *material, *extras)).collect();
    for (case, element) in cases.iter().zip(tagged(&elements)) {
        assert_eq!(element.semantic, case.4, "{case:?}");
    }
}

#[test]
fn the_printed_table_works_as_a_users_file() {
    let mut options = ImportOptions::default();
    options.rules = Some(Rules::parse(Rules::shipped_text(), "mine.toml").unwrap());
    let mut builder = ModelBuilder::new("test", Frame::default());
    let material = builder.material(Material::default());
    for class in all_classes() {
        let new = NewElement {
            name: "x".into(),
            class: Some(class.into()),
            id: class.into(),
            ..NewElement::default()
        };
        let element = builder.element(new).unwrap();
        builder.triangle(element, [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], material).unwrap();
    }
    let mut by_file = builder.finish().unwrap();
    let mut by_table = by_file.clone();
    tag(&mut by_file, &options).unwrap();
    tag(&mut by_table, &ImportOptions::default()).unwrap();
    for (a, b) in by_file.elements.iter().zip(&by_table.elements) {
        assert_eq!(a.semantic, b.semantic, "{}", a.id);
        // The same rule, found the other way.
        match (&a.tagged_by, &b.tagged_by) {
            (TagSource::UserRule(a), TagSource::Class(b)) => assert_eq!(a, b),
            (a, b) => assert_eq!((a, b), (&TagSource::None, &TagSource::None)),
        }
    }
}
