//! Surefoot as a module of Python.

use numpy::{PyArray1, PyArray2, PyArray3, PyArrayMethods, PyReadonlyArray2};
use pyo3::exceptions::{PyException, PyKeyError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};
use std::sync::Arc;
use surefoot_compiler::compiled::Parameter;
use surefoot_compiler::contour::{Detail, Settings as MeshSettings, contour};
use surefoot_compiler::diagnostic::{self, Severity};
use surefoot_compiler::evaluate::Tape;
use surefoot_compiler::graph::Function;
use surefoot_compiler::sampled::{Grid, Settings};
use surefoot_compiler::{Compiled, Live, Loader, Options, Outcome, compile as compile_scene};
use surefoot_runtime::headless::{self, Shot};
use surefoot_runtime::mesh::Assets;
use surefoot_runtime::{Gpu, Picture, ViewMode};

pyo3::create_exception!(surefoot, Error, PyException, "A scene that has errors, or that cannot do what was asked.");

/// The longest formula that is evaluated.
const LONGEST: usize = 10_000_000;

/// Files of the disk; a text stands for one that need not be there.
struct Files {
    text: Option<String>,
    name: String,
}

impl Files {
    fn of(text: Option<String>, path: Option<String>) -> PyResult<Self> {
        match (&text, path) {
            (None, None) => Err(PyValueError::new_err("give a text, or path=… of a scene")),
            (_, path) => Ok(Self { text, name: path.unwrap_or_else(|| "scene.sdf".to_owned()) }),
        }
    }
}

impl Loader for Files {
    fn read(&self, path: &str) -> Result<Vec<u8>, String> {
        match &self.text {
            Some(text) if path == self.name => Ok(text.clone().into_bytes()),
            _ => std::fs::read(path).map_err(|error| error.to_string()),
        }
    }

    fn grid(&self, path: &str, settings: Settings) -> Result<Arc<Grid>, String> {
        surefoot_runtime::mesh::field::grid(self, path, settings, &|_| {})
    }
}

/// A compiled scene.
#[pyclass(frozen)]
struct Scene {
    files: Files,
    outcome: Outcome,
}

/// Compiles a scene: a text, or the file of a path. With both, the text stands for the file, whose imports are read beside it.
#[pyfunction]
#[pyo3(signature = (text=None, *, path=None))]
fn compile(py: Python<'_>, text: Option<String>, path: Option<String>) -> PyResult<Scene> {
    let files = Files::of(text, path)?;
    let outcome = py.detach(|| compile_scene(&files, &files.name, &Options::default()));
    match outcome.compiled {
        Some(_) => Ok(Scene { files, outcome }),
        None => Err(Error::new_err(diagnostic::render(&outcome.sources, &outcome.diagnostics, false))),
    }
}

/// What is found in a scene: a list of dictionaries with `severity`, `code`, `message`, `help`, `file`, `line` and `column`.
#[pyfunction]
#[pyo3(signature = (text=None, *, path=None))]
fn check<'py>(py: Python<'py>, text: Option<String>, path: Option<String>) -> PyResult<Bound<'py, PyList>> {
    let files = Files::of(text, path)?;
    let outcome = py.detach(|| compile_scene(&files, &files.name, &Options::default()));
    let found = PyList::empty(py);
    for one in &outcome.diagnostics {
        let (file, line, column) = outcome.sources.position(one.span.file, one.span.start);
        let entry = PyDict::new(py);
        entry.set_item("severity", if one.severity == Severity::Error { "error" } else { "warning" })?;
        entry.set_item("code", one.code.row().name)?;
        entry.set_item("message", &one.message)?;
        entry.set_item("help", &one.help)?;
        entry.set_item("file", file)?;
        entry.set_item("line", line)?;
        entry.set_item("column", column)?;
        found.append(entry)?;
    }
    Ok(found)
}

/// A number, a truth or several numbers.
#[derive(FromPyObject)]
enum Value {
    One(f64),
    Several(Vec<f64>),
}

impl Scene {
    /// The scene: there is one, or there were no `Scene`.
    fn compiled(&self) -> PyResult<&Compiled> {
        self.outcome.compiled.as_ref().ok_or_else(|| Error::new_err("the scene has errors"))
    }

    /// Values of time and parameters.
    fn live(&self, time: f64, values: Option<&Bound<'_, PyDict>>) -> PyResult<Live> {
        let compiled = self.compiled()?;
        let mut live = compiled.live();
        live.time = time;
        for (name, value) in values.into_iter().flatten() {
            let name: String = name.extract()?;
            let value = match value.extract()? {
                Value::One(number) => vec![number],
                Value::Several(numbers) => numbers,
            };
            let known = compiled.parameters.iter().find(|parameter| parameter.name == name);
            put(known.ok_or_else(|| unknown(&name, compiled))?, &value, &mut live)?;
        }
        compiled.settle(&mut live);
        Ok(live)
    }

    /// A function of the scene at points.
    fn values<'py>(
        &self,
        py: Python<'py>,
        function: Function,
        points: &PyReadonlyArray2<'py, f64>,
        live: &Live,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let compiled = self.compiled()?;
        let points = points.as_array();
        if points.ncols() != 3 {
            return Err(PyValueError::new_err(format!("points have 3 columns, not {}", points.ncols())));
        }
        let points: Vec<[f64; 3]> = points.rows().into_iter().map(|row| [row[0], row[1], row[2]]).collect();
        let formula = compiled.functions.formulas.get(&(compiled.root, function)).ok_or_else(|| Error::new_err("nothing is solid"))?;
        let found = py.detach(|| {
            let tape = Tape::new(&compiled.graph, &compiled.functions.formulas, &[*formula], live, LONGEST).ok()?;
            let mut values = vec![0.0; points.len()];
            tape.evaluator().at(&points, &[], |i, value| values[i] = value[0]);
            Some(values)
        });
        found.map(|values| PyArray1::from_vec(py, values)).ok_or_else(|| Error::new_err("the field is too long"))
    }
}

/// Writes the components of a parameter.
fn put(parameter: &Parameter, value: &[f64], live: &mut Live) -> PyResult<()> {
    let name = &parameter.name;
    let Some(first) = parameter.first else {
        return Err(PyValueError::new_err(format!("{name} chooses among names: write its value into the text")));
    };
    if value.len() != parameter.default.len() {
        return Err(PyValueError::new_err(format!("{name} takes {} numbers, not {}", parameter.default.len(), value.len())));
    }
    for (i, number) in value.iter().enumerate() {
        if !(parameter.min[i]..=parameter.max[i]).contains(number) {
            return Err(PyValueError::new_err(format!("{name}: {number} is outside of {} to {}", parameter.min[i], parameter.max[i])));
        }
        live.components[first as usize + i] = *number;
    }
    Ok(())
}

fn unknown(name: &str, compiled: &Compiled) -> PyErr {
    let known: Vec<&str> = compiled.parameters.iter().map(|parameter| parameter.name.as_str()).collect();
    PyKeyError::new_err(format!("the scene has no parameter {name}; it has {}", if known.is_empty() { "none".to_owned() } else { known.join(", ") }))
}

#[pymethods]
impl Scene {
    /// The module of WGSL.
    #[getter]
    fn wgsl(&self) -> PyResult<&str> {
        Ok(&self.compiled()?.module.wgsl)
    }

    /// What a person should know of the scene, as text; empty where there is nothing.
    #[getter]
    fn warnings(&self) -> String {
        diagnostic::render(&self.outcome.sources, &self.outcome.diagnostics, false)
    }

    /// The parameters by name: a dictionary each, with `default`, `min`, `max`, `choices` and `description`.
    #[getter]
    fn parameters<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let all = PyDict::new(py);
        for parameter in &self.compiled()?.parameters {
            let entry = PyDict::new(py);
            entry.set_item("default", &parameter.default)?;
            entry.set_item("min", &parameter.min)?;
            entry.set_item("max", &parameter.max)?;
            entry.set_item("choices", &parameter.choices)?;
            entry.set_item("description", &parameter.description)?;
            all.set_item(&parameter.name, entry)?;
        }
        Ok(all)
    }

    /// Least and greatest corner of a box that holds what is solid, whatever the parameters; `None` where it has no end that is known.
    #[getter]
    fn bounds(&self) -> PyResult<Option<[[f64; 3]; 2]>> {
        Ok(self.compiled()?.bounds())
    }

    /// The field at points (n × 3), below zero inside. Keywords set parameters.
    #[pyo3(signature = (points, time=0.0, **values))]
    fn field<'py>(
        &self,
        py: Python<'py>,
        points: PyReadonlyArray2<'py, f64>,
        time: f64,
        values: Option<&Bound<'py, PyDict>>,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        self.values(py, Function::Field, &points, &self.live(time, values)?)
    }

    /// How far a ray may step from points (n × 3): no larger than the distance to the surface.
    #[pyo3(signature = (points, time=0.0, **values))]
    fn bound<'py>(
        &self,
        py: Python<'py>,
        points: PyReadonlyArray2<'py, f64>,
        time: f64,
        values: Option<&Bound<'py, PyDict>>,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        self.values(py, Function::Bound, &points, &self.live(time, values)?)
    }

    /// A picture: height × width × 4 bytes of red, green, blue (sRGB) and opacity. Needs a graphics adapter, or a program that stands for one.
    #[pyo3(signature = (width=480, height=320, time=0.0, samples=4, **values))]
    fn render<'py>(
        &self,
        py: Python<'py>,
        width: u32,
        height: u32,
        time: f64,
        samples: u32,
        values: Option<&Bound<'py, PyDict>>,
    ) -> PyResult<Bound<'py, PyArray3<u8>>> {
        let (compiled, live) = (self.compiled()?, self.live(time, values)?);
        let pixels = py.detach(|| {
            let gpu = Gpu::headless().map_err(|missing| missing.to_string())?;
            let samples = samples.max(1);
            let mode = ViewMode::Shaded;
            let mut picture = Picture::prepare(&gpu, compiled, headless::format(compiled, mode, samples), mode)?;
            let mut assets = Assets::new();
            assets.load(&self.files, compiled, &|_, _, _| {});
            picture.show_meshes(&assets.meshes(compiled))?;
            picture.show_images(assets.images());
            headless::render_with(&gpu, &mut picture, compiled, &live, &Shot { samples, ..Shot::new(width, height) })
        });
        let pixels = pixels.map_err(Error::new_err)?;
        PyArray1::from_vec(py, pixels.rgba).reshape([height as usize, width as usize, 4])
    }

    /// The surface as vertices (n × 3) and triangles (m × 3), closed. `resolution` counts cells along the longest side; a `tolerance` takes as many as
    /// needed until no triangle is found farther from the surface. `within` are two corners at which what has no end is cut off.
    #[pyo3(signature = (resolution=128, *, tolerance=None, sharp=true, within=None, time=0.0, **values))]
    #[expect(clippy::too_many_arguments, reason = "each has a name of its own in Python")]
    fn mesh<'py>(
        &self,
        py: Python<'py>,
        resolution: u32,
        tolerance: Option<f64>,
        sharp: bool,
        within: Option<[[f64; 3]; 2]>,
        time: f64,
        values: Option<&Bound<'py, PyDict>>,
    ) -> PyResult<(Bound<'py, PyArray2<f64>>, Bound<'py, PyArray2<u32>>)> {
        if tolerance.is_some_and(|tolerance| tolerance.is_nan() || tolerance <= 0.0) {
            return Err(PyValueError::new_err("a tolerance is above zero"));
        }
        let (compiled, live) = (self.compiled()?, self.live(time, values)?);
        let settings = MeshSettings { detail: tolerance.map_or(Detail::Cells(resolution), Detail::Tolerance), sharp, within };
        let mesh = py.detach(|| contour(compiled, &live, &settings, &|_| {})).map_err(|why| Error::new_err(why.to_string()))?;
        let vertices = PyArray1::from_iter(py, mesh.vertices.iter().flatten().copied()).reshape([mesh.vertices.len(), 3])?;
        let triangles = PyArray1::from_iter(py, mesh.triangles.iter().flatten().copied()).reshape([mesh.triangles.len(), 3])?;
        Ok((vertices, triangles))
    }
}

/// Signed distance fields from text: proven bounds, WGSL, values, pictures and meshes.
#[pymodule]
fn surefoot(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add("Error", module.py().get_type::<Error>())?;
    module.add_class::<Scene>()?;
    module.add_function(wrap_pyfunction!(compile, module)?)?;
    module.add_function(wrap_pyfunction!(check, module)?)
}
