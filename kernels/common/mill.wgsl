// End mills, profiles of revolution about the attack axis: ball, flat, bull, cone and ball-cone.
//
// Twin: src/tool/mill.rs.

// For x and z not below 0.
fn height(x: real, z: real) -> real {
    let rho = sqrt(x * x + z * z);
    return select(NONE, profile(rho), rho <= tool.radius);
}

fn profile(rho: real) -> real {
    if (tool.flank_to < rho) {
        return arc(tool.rim_center, tool.rim_radius, tool.rim_rise, rho);
    }
    if (tool.flank_from < rho) {
        return tool.flank_at - tool.flank_slope * (rho - tool.flank_from);
    }
    return arc(tool.corner_center, tool.corner_radius, tool.corner_rise, rho);
}

fn arc(center: real, radius: real, rise: real, rho: real) -> real {
    return leg(radius, max(rho - center, real(0))) - rise;
}

fn tangent(x: real, z: real) -> Tangent {
    let rho = sqrt(x * x + z * z);
    let has_flank = tool.flank_from < tool.radius;
    let center = select(tool.corner_center, tool.rim_center, has_flank);
    let radius = select(tool.corner_radius, tool.rim_radius, has_flank);
    let at = min(rho, center + SHARE * radius);
    var value = profile(at);
    var slope = -tool.flank_slope;
    if (tool.flank_to < at) {
        slope = arc_slope(tool.rim_center, tool.rim_radius, at);
    } else if (at <= tool.flank_from) {
        let within = min(at, tool.corner_center + SHARE * tool.corner_radius);
        slope = arc_slope(tool.corner_center, tool.corner_radius, within);
        // On the corner's steep end the plane touches farther in; it is still above all of the mill.
        value = arc(tool.corner_center, tool.corner_radius, tool.corner_rise, within)
            + slope * (at - within);
    }
    let per_rho = select(real(0), real(1) / rho, real(0) < rho);
    let along_x = x * per_rho;
    let along_z = z * per_rho;
    return Tangent(along_x * at, along_z * at, value, slope * along_x, slope * along_z);
}

fn arc_slope(center: real, radius: real, rho: real) -> real {
    let out = max(rho - center, real(0));
    return select(real(0), -out / leg(radius, out), real(0) < out);
}
