//! A small renderer: parallel view, depth buffer, shaded surfaces, lines with true hiding.
//!
//! The picture is made in bands of rows, in parallel, each at twice the size and then averaged
//! down. Every band draws in the order of the scene, so the pixels are the same for any number of
//! threads.

use super::band::{BAND, Band, Facet, SAMPLES, Stroke};
use super::shade::corner_normals;
use super::{Camera, Path, Scene, Solid};
use crate::geom::{Point3, Vector3};
use rayon::prelude::*;

/// Part of the picture left free at each side.
const MARGIN: f64 = 0.05;
/// Lines stand out this much from the surface they lie on, as part of the scene's size.
const LIFT: f64 = 0.004;

/// A picture as pixels.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Raster {
    /// Pixels per row.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Red, green, blue, row by row from the top left: `width * height` of them.
    pub pixels: Vec<[u8; 3]>,
}

/// What `camera` sees of `scene`, as large as fits.
pub fn render(scene: &Scene, camera: &Camera) -> Raster {
    let [width, height] = camera.size_px.map(|n| n.clamp(1, Camera::LARGEST_PX));
    let view = View::new(scene, camera, [width, height]);
    let facets: Vec<Facet> = scene.solids.iter().flat_map(|solid| view.facets(solid)).collect();
    let strokes: Vec<Stroke> = scene.paths.iter().flat_map(|path| view.strokes(path)).collect();
    let mut pixels = vec![[0; 3]; (width * height) as usize];
    pixels.par_chunks_mut(BAND * width as usize).enumerate().for_each(|(i_band, rows)| {
        let mut band = Band::new(i_band, rows.len() / width as usize, [width, height]);
        for facet in &facets {
            band.fill(facet);
        }
        for stroke in &strokes {
            band.stroke(stroke);
        }
        band.average_into(rows);
    });
    Raster { width, height, pixels }
}

/// From the scene to samples: right, down and into the picture.
struct View {
    frame: [Vector3; 3],
    /// Middle of what is seen, in the frame.
    middle: [f64; 2],
    /// Middle of the picture [samples].
    center: [f64; 2],
    /// Samples per mm.
    scale: f64,
    lift: f32,
}

impl View {
    fn new(scene: &Scene, camera: &Camera, size: [u32; 2]) -> Self {
        let frame = camera.frame();
        let solids = scene.solids.iter().flat_map(|s| &s.mesh.points);
        let points = solids.chain(scene.paths.iter().flat_map(|p| p.points));
        let mut range = [[f64::INFINITY, f64::NEG_INFINITY]; 3];
        for p in points {
            for (range, axis) in range.iter_mut().zip(&frame) {
                let c = axis.dot(&p.coords);
                // `min` and `max` let NaN pass by; infinities would leave nothing to see.
                if c.is_finite() {
                    *range = [range[0].min(c), range[1].max(c)];
                }
            }
        }
        let extent = range.map(|[min, max]| (max - min).max(1e-9));
        let middle = range.map(|[min, max]| if min <= max { f64::midpoint(min, max) } else { 0.0 });
        let room = size.map(|n| f64::from(n) * SAMPLES as f64 * (1.0 - 2.0 * MARGIN));
        let scale = (room[0] / extent[0]).min(room[1] / extent[1]);
        Self {
            frame,
            middle: [middle[0], middle[1]],
            center: size.map(|n| f64::from(n) * SAMPLES as f64 / 2.0),
            scale: if scale.is_finite() { scale } else { 1.0 },
            lift: (extent[0].hypot(extent[1]) * LIFT) as f32,
        }
    }

    fn project(&self, p: &Point3) -> [f32; 3] {
        let [right, up, forward] = self.frame.map(|axis| axis.dot(&p.coords));
        let x = self.center[0] + (right - self.middle[0]) * self.scale;
        let y = self.center[1] - (up - self.middle[1]) * self.scale;
        [x as f32, y as f32, forward as f32]
    }

    fn facets(&self, solid: &Solid) -> Vec<Facet> {
        let mesh = solid.mesh;
        let unit = |color: [u8; 3]| color.map(|c| f32::from(c) / 255.0);
        let color = |i: u32| unit(mesh.colors.as_ref().map_or(solid.color, |c| c[i as usize]));
        let [right, up, forward] = self.frame;
        let seen = |n: Vector3| [right.dot(&n), up.dot(&n), -forward.dot(&n)].map(|c| c as f32);
        let facet = |(i, normals): (usize, [Vector3; 3])| Facet {
            corners: mesh.corners(i).map(|p| self.project(&p)),
            normals: normals.map(seen),
            colors: mesh.triangles[i].map(color),
        };
        corner_normals(mesh).into_par_iter().enumerate().map(facet).collect()
    }

    fn strokes(&self, path: &Path) -> Vec<Stroke> {
        let radius = (path.width_px * SAMPLES as f64 / 2.0) as f32;
        let lifted = |p: &Point3| {
            let [x, y, depth] = self.project(p);
            [x, y, depth - self.lift]
        };
        let stroke = |pair: &[Point3]| Stroke {
            ends: [lifted(&pair[0]), lifted(&pair[1])],
            radius,
            color: path.color,
        };
        path.points.windows(2).map(stroke).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::super::band::BACKGROUND;
    use super::*;
    use crate::geom::{Aabb, TriMesh, shapes::cuboid};

    const GREY: [u8; 3] = [128; 3];
    const RED: [u8; 3] = [255, 0, 0];

    fn block() -> TriMesh {
        cuboid(&Aabb { min: Point3::new(-5.0, -5.0, -5.0), max: Point3::new(5.0, 5.0, 5.0) })
    }

    fn is_red(pixel: [u8; 3]) -> bool {
        pixel[0] > 150 && pixel[1] < 90
    }

    fn picture_of_path_at(z: f64) -> Raster {
        let mesh = block();
        let points = [Point3::new(-4.0, 0.0, z), Point3::new(4.0, 0.0, z)];
        let scene = Scene {
            solids: vec![Solid { mesh: &mesh, color: GREY }],
            paths: vec![Path { points: &points, color: RED, width_px: 4.0 }],
        };
        render(&scene, &Camera::top([100, 100]))
    }

    #[test]
    fn solid_fills_the_middle_and_leaves_the_margin() {
        let raster = picture_of_path_at(-20.0);
        assert_eq!(raster.pixels.len(), 100 * 100);
        assert_eq!(raster.pixels[0], BACKGROUND[0].map(|c| c as u8));
        let [middle, inside] = [raster.pixels[50 * 100 + 50], raster.pixels[8 * 100 + 8]];
        assert_eq!(middle, inside, "one flat face, one colour");
        assert_ne!(middle, raster.pixels[2 * 100 + 50]);
    }

    #[test]
    fn path_before_the_solid_is_seen_and_path_behind_it_is_not() {
        assert!(picture_of_path_at(5.0).pixels.iter().any(|&p| is_red(p)), "on the face");
        assert!(!picture_of_path_at(-5.5).pixels.iter().any(|&p| is_red(p)), "behind the block");
    }

    #[test]
    fn vertex_colours_go_before_the_colour_of_the_solid() {
        let mut mesh = block();
        mesh.colors = Some(vec![RED; mesh.points.len()]);
        let scene = Scene { solids: vec![Solid { mesh: &mesh, color: GREY }], paths: vec![] };
        let raster = render(&scene, &Camera::three_quarter([60, 40]));
        assert!(is_red(raster.pixels[20 * 60 + 30]));
    }

    #[test]
    fn scene_of_nothing_or_of_no_numbers_is_an_empty_picture() {
        let nan = TriMesh::new(
            vec![Point3::new(f64::NAN, 0.0, 0.0), Point3::origin(), Point3::new(0.0, 1e308, 0.0)],
            vec![[0, 1, 2]],
        );
        let scenes = [
            Scene::default(),
            Scene { solids: vec![Solid { mesh: &nan, color: RED }], paths: vec![] },
        ];
        for scene in scenes {
            let raster = render(&scene, &Camera::side([40, 30]));
            assert!(!raster.pixels.into_iter().any(is_red));
        }
    }

    #[test]
    fn too_large_a_picture_is_cut_to_the_largest() {
        let camera = Camera { size_px: [0, u32::MAX], ..Camera::side([0, 0]) };
        let raster = render(&Scene::default(), &camera);
        assert_eq!((raster.width, raster.height), (1, Camera::LARGEST_PX));
    }
}
