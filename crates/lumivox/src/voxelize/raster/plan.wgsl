// From the primitives of each triangle to the first primitive of each, and to a draw of all.

@group(0) @binding(0) var<storage, read_write> work: array<u32>;
@group(0) @binding(1) var<storage, read_write> arguments: array<u32>;

const THREADS: u32 = 256u;

var<workgroup> totals: array<u32, THREADS>;

@compute @workgroup_size(256)
fn main(@builtin(local_invocation_index) thread: u32) {
    let count = min(work[0], LV_BATCH);
    let each = (count + THREADS - 1u) / THREADS;
    let begin = min(thread * each, count);
    let end = min(begin + each, count);
    var total = 0u;
    for (var n = begin; n < end; n++) {
        total += work[LV_WORK_HEAD + n];
    }
    totals[thread] = total;
    workgroupBarrier();
    var first = 0u;
    for (var n = 0u; n < thread; n++) {
        first += totals[n];
    }
    for (var n = begin; n < end; n++) {
        let own = work[LV_WORK_HEAD + n];
        work[LV_WORK_HEAD + n] = first;
        first += own;
    }
    if thread == THREADS - 1u {
        arguments[0] = 3u * first;
        arguments[1] = 1u;
        arguments[2] = 0u;
        arguments[3] = 0u;
    }
}
