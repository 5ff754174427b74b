//! Where turns lie, by what they show.

use crate::geom::{PointCloud, Pose, TriMesh, Vector3};
use crate::progress::Progress;
use crate::register::coarse::CoarseOptions;
use crate::register::icp::IcpOptions;
use crate::register::pose_graph::GraphOptions;
use crate::register::views::{ViewsAligned, ViewsError, align_all};
use crate::workflow::views::why_out;

/// Where a turn lies.
pub(super) struct Laid {
    /// On the first turn that is kept; or why it lies nowhere.
    pub(super) first_from_turn: Result<Pose, Vec<String>>,
    /// How much of it and of the one it lies on best lies on each other.
    pub(super) fit: Option<f64>,
}

/// Voxels along the diagonal of the smallest turn: the usual ones of `icp`.
const FINENESS: f64 = 200.0;
/// Finer than this share of the model's voxels there is no detail: surfaces would seem far apart for their
/// points, and the pose weakly held.
const DETAIL: f64 = 0.65;

/// Lays `turns`, drawn from models with voxels of `voxel`, on each other. The most that lie together are
/// kept, or, if no two do, the first one alone.
pub(super) fn laid(
    turns: &[&TriMesh],
    voxel: f64,
    progress: &dyn Progress,
) -> Result<Vec<Laid>, ViewsError> {
    let alone = |first_from_turn| Laid { first_from_turn, fit: None };
    if let [_] = turns {
        return Ok(vec![alone(Ok(Pose::identity()))]);
    }
    let clouds: Vec<PointCloud> = turns.iter().map(|mesh| cloud(mesh)).collect();
    let clouds: Vec<&PointCloud> = clouds.iter().collect();
    let sizes = clouds.iter().map(|cloud| cloud.aabb().size().norm());
    let smallest = sizes.fold(f64::INFINITY, f64::min);
    let voxel = (smallest / FINENESS).max(DETAIL * voxel);
    let fine = IcpOptions { voxel: Some(voxel), ..IcpOptions::default() };
    let options = (&CoarseOptions::default(), &fine, &GraphOptions::default());
    let aligned = align_all(&clouds, options, progress)?;
    let poses = &aligned.stays_from_view;
    let lie_together = poses.iter().flatten().count() > 1;
    let first = poses.iter().flatten().next().filter(|_| lie_together);
    let turn = |i: usize| match (first, &poses[i]) {
        (Some(first), Some(pose)) => {
            Laid { first_from_turn: Ok(first.inverse() * pose), fit: best_fit(&aligned, i) }
        }
        (None, _) if i == 0 => alone(Ok(Pose::identity())),
        _ => alone(Err(why(&aligned, i))),
    };
    Ok((0..turns.len()).map(turn).collect())
}

/// Of pairs that are believed.
fn best_fit(aligned: &ViewsAligned, view: usize) -> Option<f64> {
    let with = aligned.pairs.iter().filter(|pair| pair.source == view || pair.target == view);
    let fits = with.filter(|pair| pair.is_believed()).map(|pair| pair.fit);
    fits.max_by(f64::total_cmp)
}

fn why(aligned: &ViewsAligned, view: usize) -> Vec<String> {
    let mut reasons = vec!["it cannot be laid on the others".to_owned()];
    reasons.extend(why_out(aligned, view));
    reasons
}

/// The vertices of a mesh, with the normals of the facets around them.
fn cloud(mesh: &TriMesh) -> PointCloud {
    let mut normals = vec![Vector3::zeros(); mesh.points.len()];
    for (i, triangle) in mesh.triangles.iter().enumerate() {
        let area = mesh.area_vector(i);
        for &i_point in triangle {
            normals[i_point as usize] += area;
        }
    }
    let unit = |normal: Vector3| normal.try_normalize(0.0).unwrap_or(Vector3::z());
    let normals = Some(normals.into_iter().map(unit).collect());
    PointCloud { points: mesh.points.clone(), normals, colors: None }
}
