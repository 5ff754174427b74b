//! stand-in
use super::Page;
use crate::workflow::cam::{CamReport, Scene};
pub fn cam_page(report: &CamReport, _scene: Option<&Scene>) -> std::io::Result<Page> {
    Ok(Page {
        title: report.part.name.clone(),
        subtitle: String::new(),
        warnings: report.warnings.clone(),
        figures: vec![],
        sections: vec![],
    })
}
pub fn cam_summary(report: &CamReport) -> String {
    format!("{report:#?}")
}
