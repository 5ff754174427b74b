//! A surface elsewhere, or as its mirror image.

use crate::geom::{Pose, Surface};

/// The mirror image of `surface`, y turned about.
pub(super) fn mirrored(surface: Surface) -> Surface {
    match surface {
        Surface::Mesh(mesh) => Surface::Mesh(mesh.mirrored()),
        Surface::Points(mut cloud) => {
            for point in &mut cloud.points {
                point.y = -point.y;
            }
            for normal in cloud.normals.iter_mut().flatten() {
                normal.y = -normal.y;
            }
            Surface::Points(cloud)
        }
        Surface::Sections(grid) => Surface::Mesh(grid.to_mesh().mirrored()),
    }
}

/// `surface` where `pose` brings it.
pub(super) fn moved(surface: Surface, pose: &Pose) -> Surface {
    match surface {
        Surface::Mesh(mesh) => Surface::Mesh(mesh.moved(pose)),
        Surface::Points(mut cloud) => {
            for point in &mut cloud.points {
                *point = pose * *point;
            }
            for normal in cloud.normals.iter_mut().flatten() {
                *normal = pose.rotation * *normal;
            }
            Surface::Points(cloud)
        }
        Surface::Sections(grid) => Surface::Mesh(grid.to_mesh().moved(pose)),
    }
}
