//! What stands before the simulated camera, and how light falls on it.

use super::raster::Seen;
use super::texture::{GREY, Texture, TextureKind};
use crate::geom::{Aabb, Point3, Pose, TriMesh, Vector3, shapes};
use crate::rgbd::{Camera, Image};

/// A mesh and its paint.
#[derive(Debug, Clone, PartialEq)]
pub struct Scene {
    /// What is seen, in the world; both sides of every triangle.
    pub mesh: TriMesh,
    /// What it is painted with.
    pub texture: Texture,
}

/// The four cases of chapter 2 of the thesis: whether there is something to see, and something to feel.
/// All face -Y, about the origin, Z up.
#[derive(
    Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize, clap::ValueEnum,
)]
#[serde(rename_all = "kebab-case")]
pub enum BuiltinScene {
    /// A wall with patches: only visual methods can tell how the camera moves along it.
    TexturedFlat,
    /// A bare wall: nothing can.
    PlainFlat,
    /// A folded wall, a floor, a box and a ball, with patches.
    TexturedStructured,
    /// The same bare: only geometry tells.
    PlainStructured,
}

/// Towards the lamps, fixed in the world; the first is the brighter one.
const LAMPS: [[f64; 3]; 2] = [[-0.45, -0.70, 0.55], [0.75, 0.10, -0.65]];
/// What each lamp gives, and what is bright without any.
const BRIGHTNESS: [f64; 2] = [0.55, 0.20];
const AMBIENT: f64 = 0.38;
/// Where nothing is seen, 0 to 255.
const DARK: [u8; 3] = [16, 18, 22];
/// A pixel's paint is looked at in four places this far from its middle [px].
const QUARTER: f64 = 0.25;

impl Scene {
    /// A scene of a mesh in `texture`.
    pub fn new(mesh: TriMesh, texture: Texture) -> Self {
        Self { mesh, texture }
    }

    /// The colours of what was seen.
    pub(super) fn paint(
        &self,
        seen: &Image<Seen>,
        camera: &Camera,
        world_from_camera: &Pose,
    ) -> Image<[u8; 3]> {
        Image::from_rows(seen.width(), seen.height(), DARK, |y, row| {
            for ((x, color), seen) in row.iter_mut().enumerate().zip(seen.row(y)) {
                if seen.depth > 0.0 {
                    let rays = [-QUARTER, QUARTER].map(|dy| {
                        [-QUARTER, QUARTER].map(|dx| {
                            let [x, y] = camera.ray([x as f64 + dx, y as f64 + dy]);
                            world_from_camera * Vector3::new(x, y, 1.0)
                        })
                    });
                    let eye = Point3::from(world_from_camera.translation.vector);
                    *color = self.color(seen.triangle as usize, &eye, rays.as_flattened());
                }
            }
        })
    }

    /// The colour of a triangle where `rays` from `eye` meet its plane, on the mean.
    fn color(&self, i_triangle: usize, eye: &Point3, rays: &[Vector3]) -> [u8; 3] {
        let [a, ..] = self.mesh.corners(i_triangle);
        let normal = self.mesh.area_vector(i_triangle);
        let mut sum = [0.0; 3];
        for ray in rays {
            // A ray beside a triangle seen nearly edge on may meet its plane anywhere: that is still the
            // colour of the plane, and finite.
            let along = normal.dot(&(a - eye)) / normal.dot(ray);
            let place = if along.is_finite() { eye + ray * along } else { a };
            let color =
                self.texture.color(&place).unwrap_or_else(|| self.plain(i_triangle, &place));
            sum = [0, 1, 2].map(|k| sum[k] + color[k] / rays.len() as f64);
        }
        let light = lit(&normal, &(eye - a));
        sum.map(|c| (255.0 * c * light).round().clamp(0.0, 255.0) as u8)
    }

    /// The colour of the vertices around a place of a triangle, or grey.
    fn plain(&self, i_triangle: usize, place: &Point3) -> [f64; 3] {
        let wanted = self.texture.kind == TextureKind::Vertices;
        let Some(colors) = self.mesh.colors.as_ref().filter(|_| wanted) else { return GREY };
        let [a, b, c] = self.mesh.corners(i_triangle);
        let normal = (b - a).cross(&(c - a));
        let share = |from: &Point3, to: &Point3| {
            let part = (to - from).cross(&(place - from)).dot(&normal) / normal.norm_squared();
            part.clamp(0.0, 1.0)
        };
        let shares = [share(&b, &c), share(&c, &a), share(&a, &b)];
        let total: f64 = shares.iter().sum();
        let corners = self.mesh.triangles[i_triangle].map(|i| colors[i as usize]);
        let mean = |k: usize| (0..3).map(|i| shares[i] * f64::from(corners[i][k])).sum::<f64>();
        if total > 0.0 { [0, 1, 2].map(|k| mean(k) / total / 255.0) } else { GREY }
    }
}

/// How bright a surface is whose normal may point either way; it is lit on the side it is seen from.
fn lit(normal: &Vector3, towards_eye: &Vector3) -> f64 {
    let Some(normal) = normal.try_normalize(0.0) else { return AMBIENT };
    let normal = if normal.dot(towards_eye) < 0.0 { -normal } else { normal };
    let lamps = LAMPS.into_iter().map(Vector3::from).zip(BRIGHTNESS);
    AMBIENT + lamps.map(|(lamp, b)| b * normal.dot(&lamp.normalize()).max(0.0)).sum::<f64>()
}

impl BuiltinScene {
    /// The scene.
    pub fn build(self) -> Scene {
        let (kind, mesh) = match self {
            Self::TexturedFlat => (TextureKind::Patches, wall()),
            Self::PlainFlat => (TextureKind::Plain, wall()),
            Self::TexturedStructured => (TextureKind::Patches, structure()),
            Self::PlainStructured => (TextureKind::Plain, structure()),
        };
        Scene::new(mesh, Texture { kind, ..Texture::default() })
    }
}

/// Ten metres by six, so that no camera sees its rim; the front at y = 0.
fn wall() -> TriMesh {
    let corner = |x, z| Point3::new(x, 0.0, z);
    let (x, z) = (5000.0, 3000.0);
    let points = vec![corner(-x, -z), corner(x, -z), corner(x, z), corner(-x, z)];
    TriMesh::new(points, vec![[0, 1, 2], [0, 2, 3]])
}

/// A wall folded like a screen alone would let the camera slide up and down unnoticed; the floor, the box
/// and the ball hold it in all six directions.
fn structure() -> TriMesh {
    let (fold, depth, height) = (400.0, 250.0, 900.0);
    let mut mesh = TriMesh::default();
    for i in -5..=5 {
        let y = if i % 2 == 0 { 0.0 } else { -depth };
        let x = f64::from(i) * fold;
        mesh.points.extend([-600.0, height].map(|z| Point3::new(x, y, z)));
    }
    for i in 0..10 {
        let [below, above, next, across] = [2 * i, 2 * i + 1, 2 * i + 2, 2 * i + 3];
        mesh.triangles.extend([[below, next, across], [below, across, above]]);
    }
    let solid = |min: [f64; 3], max: [f64; 3]| {
        shapes::cuboid(&Aabb { min: Point3::from(min), max: Point3::from(max) })
    };
    mesh.append(solid([-2000.0, -1500.0, -650.0], [2000.0, 50.0, -600.0]));
    mesh.append(solid([150.0, -700.0, -600.0], [500.0, -350.0, -150.0]));
    mesh.append(shapes::sphere(&Point3::new(-350.0, -550.0, -300.0), 200.0, 48));
    mesh
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn vertex_colours_are_mixed_over_a_triangle() {
        let mut mesh = wall();
        mesh.colors = Some(vec![[255, 0, 0], [0, 255, 0], [0, 0, 255], [0; 3]]);
        let texture = Texture { kind: TextureKind::Vertices, ..Texture::default() };
        let scene = Scene::new(mesh, texture);
        let [a, b, c] = scene.mesh.corners(0);
        assert_eq!(scene.plain(0, &a), [1.0, 0.0, 0.0]);
        let middle = Point3::from((a.coords + b.coords + c.coords) / 3.0);
        let mean = scene.plain(0, &middle);
        assert!(mean.iter().all(|c| (c - 1.0 / 3.0).abs() < 1e-12), "{mean:?}");
        let grey = Scene { texture: Texture::default(), ..scene };
        assert_eq!(grey.plain(0, &a), GREY);
    }

    #[test]
    fn both_sides_of_a_surface_are_lit_alike_and_light_does_not_move_with_the_camera() {
        let normal = Vector3::new(-0.3, -1.0, 0.4);
        let eye = Vector3::new(0.0, -500.0, 0.0);
        assert_eq!(lit(&normal, &eye), lit(&-normal, &eye));
        assert_eq!(lit(&normal, &eye), lit(&normal, &Vector3::new(300.0, -100.0, 20.0)));
        assert!(lit(&normal, &eye) > lit(&Vector3::new(0.3, -1.0, -0.8), &eye));
    }

    #[test]
    fn structure_has_flat_pieces_in_every_direction_and_flat_has_one() {
        let directions = |scene: BuiltinScene| {
            let mesh = scene.build().mesh;
            let mut spread = crate::geom::Matrix3::zeros();
            for normal in (0..mesh.triangles.len()).map(|i| mesh.area_vector(i)) {
                spread += normal * normal.transpose() / normal.norm();
            }
            let values = spread.symmetric_eigenvalues();
            values.min() / values.max()
        };
        assert!(directions(BuiltinScene::PlainStructured) > 0.1);
        assert!(directions(BuiltinScene::TexturedFlat) < 1e-9);
    }
}
