//! What the device has done, and what it holds, back on the processor.

use crate::gpu::Gpu;

/// Waits until the work is done.
pub(crate) fn wait(gpu: &Gpu, submitted: wgpu::SubmissionIndex) -> Result<(), String> {
    let poll = wgpu::PollType::Wait { submission_index: Some(submitted), timeout: None };
    gpu.device().poll(poll).map(|_| ()).map_err(|e| e.to_string())
}

/// The bytes of a buffer once the work that fills it is done.
pub(crate) fn read(
    gpu: &Gpu,
    buffer: &wgpu::Buffer,
    submitted: wgpu::SubmissionIndex,
) -> Result<Vec<u8>, String> {
    let (sender, receiver) = std::sync::mpsc::channel();
    buffer.map_async(wgpu::MapMode::Read, .., move |result| {
        // Nobody waits any more where this fails.
        let _ = sender.send(result);
    });
    wait(gpu, submitted)?;
    match receiver.recv() {
        Ok(Ok(())) => {}
        Ok(Err(error)) => return Err(error.to_string()),
        Err(_) => return Err("the device was lost".to_owned()),
    }
    let bytes = buffer.get_mapped_range(..).map_err(|e| e.to_string())?.to_vec();
    buffer.unmap();
    Ok(bytes)
}
