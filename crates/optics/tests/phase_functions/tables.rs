//! Tables: what they say is what is sampled, every format reads, and whatever is wrong has a line and a mend.

use tyndall_optics::phase_function::{TabulatedPhase, parse_phase_table, read_phase_table};
use tyndall_optics::{PhaseFunction, SpectralPhase};

fn table(text: &str) -> SpectralPhase {
    parse_phase_table(text).unwrap_or_else(|error| panic!("{error}: {text}"))
}

/// The cumulative distribution of a table, by the trapezoid rule cell by cell, which is exact for it.
fn cumulative(table: &TabulatedPhase, cos: f64) -> f64 {
    let (x, y) = (table.cosines(), table.values());
    let area = (0..x.len() - 1).take_while(|i| x[*i] < cos).map(|i| {
        let end = cos.min(x[i + 1]);
        let at_end = y[i] + (y[i + 1] - y[i]) * (end - x[i]) / (x[i + 1] - x[i]);
        std::f64::consts::TAU * 0.5 * (y[i] + at_end) * (end - x[i])
    });
    area.sum()
}

#[test]
fn a_table_is_sampled_exactly() {
    let spiky = [(-1.0, 1.0), (-0.5, 0.0), (0.0, 0.0), (0.3, 2.0), (0.301, 900.0), (0.302, 0.0), (1.0, 5.0)];
    let PhaseFunction::Tabulated(c1) = super::quadrature::c1_cloud() else { unreachable!() };
    for table in [TabulatedPhase::from_cosines(&spiky).unwrap(), (*c1).clone()] {
        assert!((cumulative(&table, 1.0) - 1.0).abs() < 1e-12);
        let phase = PhaseFunction::Tabulated(table.clone().into());
        for i in 0..10_000 {
            let u = f64::from(i) / 10_000.0;
            let cos = phase.sample_cosine(u);
            assert!((cumulative(&table, cos) - u).abs() < 1e-12, "{u}: {cos}");
        }
    }
}

/// A table of a known function is that function, to the error of its steps; rows may fall, and the normalisation is free.
#[test]
fn a_fine_table_is_the_function_it_was_made_from() {
    let truth = PhaseFunction::HenyeyGreenstein { g: 0.6 };
    let rows: Vec<(f64, f64)> = (0..=1800)
        .map(|i| f64::from(i) / 10.0)
        .map(|a| (a, 7.0 * truth.value_at_cosine(a.to_radians().cos())))
        .collect();
    let phase = PhaseFunction::Tabulated(TabulatedPhase::from_degrees(&rows).unwrap().into());
    assert!((phase.mean_cosine() - 0.6).abs() < 1e-5);
    for i in -99..=99 {
        let cos = f64::from(i) / 99.0;
        assert!((phase.value_at_cosine(cos) / truth.value_at_cosine(cos) - 1.0).abs() < 1e-4, "{cos}");
    }
}

#[test]
fn every_format_reads_as_the_same_table() {
    let plain = table("0 4\n90 1\n180 2\n");
    for text in [
        "angle_deg,value\n0,4\n90,1\n180,2\n",
        "\u{feff}theta;p\r\n0;4\r\n90;1\r\n180;2\r\n",
        "# a comment\n! another\n  180.0  0.2E+01\n  90.0 1 # the minimum\n\n   0.0\t4\n",
        "0 400\n90 100\n180 200",
    ] {
        assert_eq!(table(text), plain, "{text}");
    }
    let PhaseFunction::Tabulated(by_cosine) = table("cos_theta value\n1 4\n0 1\n-1 2\n").at(550.0) else {
        unreachable!()
    };
    let expected = TabulatedPhase::from_cosines(&[(-1.0, 2.0), (0.0, 1.0), (1.0, 4.0)]).unwrap();
    assert_eq!(*by_cosine, expected);
    // Beyond the rows the ends' values hold.
    let part = table("10 1\n170 1\n").at(550.0);
    assert!((part.value_at_cosine(1.0) - 0.25 / std::f64::consts::PI).abs() < 1e-12);
}

#[test]
fn columns_are_wavelengths_and_are_mixed_between() {
    let two = "0,4,1\n90,1,1\n180,2,1\n";
    let [by_csv, by_comment] =
        [format!("angle_deg,450,650nm\n{two}"), format!("# angle_deg 450 value_650\n{two}")]
            .map(|t| table(&t));
    assert_eq!(by_csv, by_comment);
    assert_eq!(by_csv.wavelengths_nm(), [450.0, 650.0]);
    let at = |nm: f64, cos: f64| by_csv.at(nm).value_at_cosine(cos);
    for cos in [-1.0, -0.3, 0.0, 0.8] {
        assert_eq!(at(300.0, cos), at(450.0, cos));
        assert_eq!(at(900.0, cos), at(650.0, cos));
        assert!((at(500.0, cos) - (0.75 * at(450.0, cos) + 0.25 * at(650.0, cos))).abs() < 1e-15);
    }
    assert_eq!(*by_csv.nearest(500.0), by_csv.phases()[0]);
    assert_eq!(*by_csv.nearest(560.0), by_csv.phases()[1]);
}

#[test]
fn what_is_no_table_is_told_with_its_line() {
    for (text, words) in [
        ("", vec!["no rows"]),
        ("# nothing\n", vec!["no rows"]),
        ("0 1\n", vec!["two rows"]),
        ("0\n1\n", vec!["line 1", "an angle in degrees and a value"]),
        ("0 1\n90 1 2\n", vec!["line 2", "3 numbers", "have 2"]),
        ("0 1\n90 -1\n", vec!["line 2", "negative"]),
        ("0 1\n90 nan\n", vec!["line 2", "not finite"]),
        ("0 1\n90 1e999\n", vec!["line 2", "not finite"]),
        ("0 0\n90 0\n", vec!["0"]),
        ("0 1\n90 1\n90 2\n", vec!["line 3", "sort"]),
        ("0 1\n90 1\n45 2\n", vec!["line 3", "sort"]),
        ("0 1\n190 1\n", vec!["line 2", "190", "0 to 180"]),
        ("-1 1\n1 1\n", vec!["line 1", "cos_theta,value"]),
        ("cos_theta value\n0 1\n2 1\n", vec!["line 3", "-1 to 1"]),
        ("0 1 2\n90 1 2\n", vec!["line 1", "wavelengths", "angle_deg,450,550,650"]),
        ("angle_deg,450,450\n0,1,1\n180,1,1\n", vec!["wavelengths", "differ"]),
        ("hello world\n0 1\n", vec!["line 1", "angle_deg,value"]),
        ("0 1\nninety 1\n", vec!["line 2", "numbers"]),
    ] {
        let error = parse_phase_table(text).expect_err(text).to_string();
        for word in words {
            assert!(error.contains(word), "`{word}` is not in `{error}` for {text:?}");
        }
        assert!(!error.contains('\n'));
    }
}

#[test]
fn files_that_are_no_text_or_not_there_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("phase.txt");
    assert!(read_phase_table(&path).unwrap_err().to_string().contains("no such file"));
    std::fs::write(&path, b"\xff\xfe\x00").unwrap();
    assert!(read_phase_table(&path).unwrap_err().to_string().contains("not text"));
    assert!(read_phase_table(folder.path()).is_err());
    std::fs::write(&path, "0 1\n180 1\n").unwrap();
    assert!(read_phase_table(&path).unwrap().is_grey());
}
