// From the tiles of each triangle in the list to the first tile of each, and to as many workgroups as there are tiles.

@group(0) @binding(0) var<storage, read_write> work: array<u32>;
@group(0) @binding(1) var<storage, read_write> arguments: array<u32>;

const THREADS: u32 = 256u;
// Most workgroups along one dimension of a dispatch, and a power of two.
const COLUMNS: u32 = 32768u;

var<workgroup> totals: array<u32, THREADS>;

@compute @workgroup_size(256)
fn main(@builtin(local_invocation_index) thread: u32) {
    let count = min(work[0], LV_BATCH);
    let each = (count + THREADS - 1u) / THREADS;
    let begin = min(thread * each, count);
    let end = min(begin + each, count);
    let tiles = LV_WORK_HEAD + LV_BATCH;
    var total = 0u;
    for (var n = begin; n < end; n++) {
        total += work[tiles + n];
    }
    totals[thread] = total;
    workgroupBarrier();
    var first = 0u;
    for (var n = 0u; n < thread; n++) {
        first += totals[n];
    }
    for (var n = begin; n < end; n++) {
        let own = work[tiles + n];
        work[tiles + n] = first;
        first += own;
    }
    if thread == THREADS - 1u {
        // What stands in the list now is for this batch alone; the next begins anew.
        work[0] = 0u;
        work[1] = first;
        work[2] = count;
        arguments[0] = min(first, COLUMNS);
        arguments[1] = (first + COLUMNS - 1u) / COLUMNS;
        arguments[2] = 1u;
    }
}
