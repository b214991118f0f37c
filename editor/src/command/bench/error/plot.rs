//! Curves of time against error, as SVG.

use super::truth::Errors;
use super::rows::{Row, Scene};
use crate::command::console::Failure;
use plotters::prelude::*;
use std::path::Path;

/// Errors below this are drawn here: the axis is logarithmic.
const LEAST: f64 = 1e-3;

/// What is drawn against time.
type Measure = fn(&Row) -> f64;

/// Two charts side by side: time against the depth's p99 error, and against missed pixels. Time is the ratio to the first method,
/// and it and the depth's error are medians over the scenes; missed pixels are added up.
pub fn write(file: &Path, adapter: &str, scenes: &[Scene]) -> Result<(), Failure> {
    draw(file, adapter, scenes).map_err(|e| Failure::usage(format!("can't write {}: {e}", file.display())))
}

/// A method's place: name, time, error.
type Place = (String, f64, f64);

fn places(scenes: &[Scene], measure: Measure, join: fn(&[f64]) -> f64) -> Vec<Place> {
    let mut names: Vec<&str> = Vec::new();
    for row in scenes.iter().flat_map(|s| &s.rows) {
        if !names.contains(&row.method.as_str()) {
            names.push(&row.method);
        }
    }
    names
        .into_iter()
        .map(|name| {
            let rows: Vec<&Row> = scenes.iter().flat_map(|s| &s.rows).filter(|r| r.method == name).collect();
            let ratios: Vec<f64> = rows.iter().map(|r| r.ratio).collect();
            let error = join(&rows.iter().map(|r| measure(r)).collect::<Vec<_>>());
            (name.to_owned(), Errors::percentile(&ratios, 50.0), error)
        })
        .collect()
}

fn draw(file: &Path, adapter: &str, scenes: &[Scene]) -> Result<(), Box<dyn std::error::Error>> {
    let area = SVGBackend::new(file, (1200, 560)).into_drawing_area();
    area.fill(&WHITE)?;
    let title = format!("{} scenes on {adapter}", scenes.len());
    let area = area.titled(&title, ("sans-serif", 18))?;
    let (left, right) = area.split_horizontally(600);
    let depth = places(scenes, |r| Errors::percentile(&r.errors.depth, 99.0).max(LEAST), |all| Errors::percentile(all, 50.0));
    chart(&left, "p99 of |t - t*|, in widths of a pixel", &depth, LEAST)?;
    // One is added, so that none has a place on the axis.
    let missed = places(scenes, |r| r.errors.missed as f64, |all| all.iter().sum());
    let missed: Vec<Place> = missed.into_iter().map(|(name, time, count)| (name, time, count + 1.0)).collect();
    chart(&right, "missed pixels, plus one", &missed, 0.8)?;
    area.present()?;
    Ok(())
}

fn chart(
    area: &DrawingArea<SVGBackend<'_>, plotters::coord::Shift>,
    label: &str,
    places: &[Place],
    least: f64,
) -> Result<(), Box<dyn std::error::Error>> {
    let slowest = places.iter().map(|p| p.1).fold(1.0, f64::max);
    let worst = places.iter().map(|p| p.2).fold(1.0, f64::max);
    let fastest = places.iter().map(|p| p.1).fold(1.0, f64::min);
    let mut chart = ChartBuilder::on(area)
        .margin(16)
        .x_label_area_size(40)
        .y_label_area_size(60)
        .build_cartesian_2d((fastest * 0.8..slowest * 3.0).log_scale(), (least * 0.8..worst * 2.0).log_scale())?;
    chart.configure_mesh().x_desc("time, as a ratio to the first method").y_desc(label).draw()?;
    // Methods of one sweep are joined.
    let mut families: Vec<(&str, Vec<&Place>)> = Vec::new();
    for place in places {
        let family = place.0.split(' ').next().unwrap_or("");
        match families.iter_mut().find(|(name, _)| *name == family) {
            Some((_, members)) => members.push(place),
            None => families.push((family, vec![place])),
        }
    }
    for (i, (family, members)) in families.iter().enumerate() {
        let color = Palette99::pick(i).to_rgba();
        let points = members.iter().map(|p| (p.1, p.2));
        chart.draw_series(LineSeries::new(points.clone(), &color.mix(0.5)))?;
        let name = if members.len() > 1 { format!("{family}: {}", members.len()) } else { members[0].0.clone() };
        chart
            .draw_series(points.map(|at| Circle::new(at, 4, color.filled())))?
            .label(name)
            .legend(move |at| Circle::new(at, 4, color.filled()));
    }
    let position = SeriesLabelPosition::UpperRight;
    chart.configure_series_labels().position(position).background_style(WHITE.mix(0.8)).border_style(BLACK).draw()?;
    Ok(())
}
