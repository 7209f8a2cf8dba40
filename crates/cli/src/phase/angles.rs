//! Lists of angles: `0,30,90`, and `0,5,...,180` with all the steps between.

/// Angles in degrees, each from 0 to 180.
#[derive(Debug, Clone, PartialEq)]
pub struct Angles(pub Vec<f64>);

/// More than any table needs.
const MOST: f64 = 100_000.0;

impl std::str::FromStr for Angles {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let mend = "write angles from 0 to 180, such as 0,30,90 or 0,5,...,180";
        let mut angles: Vec<f64> = Vec::new();
        let mut has_gap = false;
        for part in text.split(',').map(str::trim) {
            if part == "..." || part == "…" {
                if has_gap || angles.len() < 2 {
                    return Err(format!("`...` needs two angles before it, which tell the step; {mend}"));
                }
                has_gap = true;
                continue;
            }
            let angle = part.parse().ok().filter(|angle| (0.0..=180.0).contains(angle));
            let angle: f64 = angle.ok_or_else(|| format!("`{part}` is no angle; {mend}"))?;
            if std::mem::take(&mut has_gap) {
                fill(&mut angles, angle)?;
            } else {
                angles.push(angle);
            }
        }
        if has_gap {
            return Err(format!("`...` needs an angle after it; {mend}"));
        }
        Ok(Self(angles))
    }
}

/// Goes on with the step of the last two angles to `end`.
fn fill(angles: &mut Vec<f64>, end: f64) -> Result<(), String> {
    let [.., before, start] = angles[..] else { return Ok(()) };
    let step = start - before;
    let steps = (end - start) / step;
    if !steps.is_finite() || steps < 0.0 {
        return Err(format!("the steps from {before} to {start} never come to {end}"));
    }
    if steps > MOST {
        return Err(format!("more than {MOST} angles; take a larger step"));
    }
    // A step such as 0.1 is not exact: the end is still met.
    let whole = (steps + 1e-6).floor();
    angles.extend(
        (1..=whole as usize).map(|n| if n as f64 >= steps - 1e-6 { end } else { start + n as f64 * step }),
    );
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_are_filled_in() {
        let angles = |text: &str| text.parse::<Angles>().map(|angles| angles.0);
        assert_eq!(angles("0, 30,90"), Ok(vec![0.0, 30.0, 90.0]));
        assert_eq!(angles("0,0.1,...,0.3,180").unwrap(), [0.0, 0.1, 0.2, 0.3, 180.0]);
        assert_eq!(angles("180,170,…,145").unwrap(), [180.0, 170.0, 160.0, 150.0]);
        assert_eq!(angles("0,1,...,180").unwrap().len(), 181);
        for wrong in [
            "",
            "x",
            "-1",
            "181",
            "nan",
            "...,3",
            "1,...,3",
            "0,1,...",
            "0,0,...,9",
            "1,0,...,9",
            "0,1e-9,...,180",
        ] {
            assert!(angles(wrong).is_err(), "{wrong}");
        }
    }
}
