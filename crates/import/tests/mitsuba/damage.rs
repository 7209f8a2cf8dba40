//! Damaged scenes: a result or one line, whatever is in them.

use std::fs;

use tyndall_import::{Sidecar, import_mitsuba};

use crate::support::*;

/// A scene with most of what there is.
const RICH: &str = r#"<scene version="3.0.0">
  <default name="spp" value="16"/><default name="g" value="0.3"/>
  <integrator type="volpath"><integer name="max_depth" value="-1"/></integrator>
  <sensor type="thinlens"><float name="fov" value="40"/><string name="fov_axis" value="smaller"/><float name="aperture_radius" value="0.1"/>
    <transform name="to_world"><scale x="-1"/><lookat origin="0,0.3,3.4" target="0,0,0" up="0,1,0"/></transform>
    <sampler type="independent"><integer name="sample_count" value="$spp"/></sampler>
    <film type="hdrfilm"><integer name="width" value="64"/><integer name="crop_width" value="32"/></film><ref name="medium" id="fog"/></sensor>
  <medium type="homogeneous" id="fog"><float name="scale" value="8"/><rgb name="sigma_t" value="0.1,0.2,0.3"/>
    <phase type="blendphase"><float name="weight" value="0.5"/><phase type="hg"><float name="g" value="$g"/></phase>
      <phase type="tabphase"><string name="values" value="1,2,3"/></phase></phase></medium>
  <medium type="heterogeneous" id="cloud"><volume name="sigma_t" type="gridvolume"><string name="filename" value="a.vol"/>
    <transform name="to_world"><rotate y="1" angle="30"/><matrix value="1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1"/></transform></volume></medium>
  <bsdf type="twosided" id="wall"><bsdf type="diffuse"><texture type="checkerboard" name="reflectance">
    <rgb name="color0" value="0.1"/><transform name="to_uv"><scale value="3"/></transform></texture></bsdf></bsdf>
  <bsdf type="mask" id="veil"><float name="opacity" value="0.5"/><ref id="wall"/></bsdf><alias id="veil" as="net"/>
  <shape type="cube" id="box"><transform name="to_world"><scale x="1" y="0.7" z="1"/></transform><bsdf type="null"/>
    <ref name="interior" id="cloud"/><ref name="exterior" id="fog"/></shape>
  <shape type="shapegroup" id="group"><shape type="cylinder"><point name="p1" x="0" y="2" z="0"/><ref id="net"/></shape></shape>
  <shape type="instance"><ref id="group"/><transform name="to_world"><translate x="2"/></transform></shape>
  <shape type="rectangle"><boolean name="flip_normals" value="true"/><emitter type="area"><spectrum name="radiance" value="400:1, 700:2"/></emitter></shape>
  <shape type="sphere"><bsdf type="roughconductor"><string name="material" value="Cu"/><float name="alpha" value="0.2"/></bsdf></shape>
  <emitter type="spot"><rgb name="intensity" value="5"/></emitter><emitter type="directional"><vector name="direction" value="0,-1,0"/></emitter>
  <emitter type="constant"><spectrum type="blackbody" name="radiance"><float name="temperature" value="4000"/></spectrum></emitter>
</scene>
"#;

/// A random number after another (Steele, Lea and Flood 2014, SplitMix).
fn next(state: &mut u64) -> usize {
    *state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
    let mut z = *state;
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    (z ^ (z >> 31)) as usize
}

/// The text with some of it changed, lost, doubled or put elsewhere.
fn damaged(text: &[u8], state: &mut u64) -> Vec<u8> {
    let words: [&[u8]; 16] = [
        b"-1",
        b"0",
        b"1e308",
        b"nan",
        b"$",
        b"\\$",
        b"\"",
        b"<",
        b">",
        b"/>",
        b"&amp;",
        b"\xff",
        b"sphere",
        b"id",
        b"99999999999",
        b"<!--",
    ];
    let mut bytes = text.to_vec();
    for _ in 0..1 + next(state) % 2 {
        let at = next(state) % bytes.len();
        let end = (at + next(state) % 60).min(bytes.len());
        match next(state) % 6 {
            0 => bytes[at] = next(state) as u8,
            1 => drop(bytes.drain(at..end)),
            2 => {
                let part = bytes[at..end].to_vec();
                let to = next(state) % bytes.len();
                bytes.splice(to..to, part);
            }
            3 => {
                // A number gets another.
                let digits = bytes.iter().skip(at).position(u8::is_ascii_digit);
                let at = digits.map_or(at, |digits| at + digits);
                let word = words[next(state) % words.len()];
                bytes.splice(at..(at + 1).min(bytes.len()), word.iter().copied());
            }
            4 => {
                let word = words[next(state) % words.len()];
                bytes.splice(at..at, word.iter().copied());
            }
            _ => bytes.truncate(at.max(1)),
        }
    }
    bytes
}

#[test]
fn damaged_scenes_lead_to_a_scene_or_to_one_line() {
    let full = std::env::var("TYNDALL_PROOF").is_ok_and(|value| value == "full");
    let count = if full { 40_000 } else { 2_000 };
    let mut values = vec![0.5; 27];
    values[13] = 2.0;
    let grid = volume([3; 3], 1, [[0.0; 3], [1.0; 3]], &values);
    let folder = Folder::with(&[("scene.xml", RICH.as_bytes()), ("a.vol", &grid)]);
    let whole = folder.import();
    assert!(whole.description.shapes.len() > 3 && whole.description.materials.len() == 2);
    let sidecar = folder.0.path().join("sidecar");
    let mut state = 20_260_108;
    let (mut sound, mut refused) = (0, 0);
    for number in 0..count {
        let text = damaged(RICH.as_bytes(), &mut state);
        fs::write(folder.0.path().join("scene.xml"), &text).unwrap();
        match import_mitsuba(&folder.0.path().join("scene.xml"), &Sidecar::new(&sidecar), &[]) {
            Ok(imported) => {
                sound += 1;
                let violations = imported.description.violations();
                assert_eq!(violations, [], "{number}: {}", String::from_utf8_lossy(&text));
                // Whatever was read can be written and read again.
                if number % 10 == 0 {
                    assert_sound(&imported.description);
                }
            }
            Err(error) => {
                refused += 1;
                let error = error.to_string();
                assert_eq!(error.lines().count(), 1, "{number}: {error}");
            }
        }
    }
    assert!(sound > count / 50 && refused > count / 50, "{sound} {refused}");
}
