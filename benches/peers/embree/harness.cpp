// Embree on the same triangles and the same rays: how long a tree takes to build, and single rays to be answered.
//
// Usage: harness RAYS ANSWERS THREADS ROUNDS
//
// RAYS (little endian): u32 triangles, u32 rays, 9 f32 a triangle, 6 f32 a ray (origin, direction). ANSWERS: u32 a ray, the
// triangle or 4294967295. One JSON object goes to standard output: the milliseconds of each round, the fastest first.
//
// The scene is Embree's default: medium build quality (binned surface area heuristic), not robust, not compact. Rays are
// answered by rtcIntersect1, with the flag for coherent rays. Geometry shares the buffers of this program, which costs
// nothing. Several threads take runs of 4096 rays each.

#include <embree3/rtcore.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <string>
#include <thread>
#include <vector>

static double milliseconds() {
    using namespace std::chrono;
    return duration<double, std::milli>(steady_clock::now().time_since_epoch()).count();
}

static void fail(const char* what) {
    std::fprintf(stderr, "harness: %s\n", what);
    std::exit(1);
}

struct Input {
    std::vector<float> corners;     // 9 a triangle and one more, since Embree reads 16 bytes at the last corner
    std::vector<uint32_t> indices;  // 3 a triangle
    std::vector<float> rays;        // 6 a ray
    uint32_t triangle_count = 0, ray_count = 0;
};

static Input read(const char* name) {
    Input input;
    FILE* file = std::fopen(name, "rb");
    if (!file) fail("cannot open the rays");
    uint32_t counts[2];
    if (std::fread(counts, 4, 2, file) != 2) fail("the rays are too short");
    input.triangle_count = counts[0];
    input.ray_count = counts[1];
    input.corners.resize(size_t(9) * counts[0] + 4);
    input.rays.resize(size_t(6) * counts[1]);
    if (std::fread(input.corners.data(), 36, counts[0], file) != counts[0]) fail("the rays are too short");
    if (std::fread(input.rays.data(), 24, counts[1], file) != counts[1]) fail("the rays are too short");
    std::fclose(file);
    input.indices.resize(size_t(3) * counts[0]);
    for (size_t i = 0; i < input.indices.size(); i++) input.indices[i] = uint32_t(i);
    return input;
}

// A finished scene; the milliseconds of committing it, all that Embree does with the geometry, go to `build`.
static RTCScene build(RTCDevice device, Input& input, double& build_ms) {
    RTCScene scene = rtcNewScene(device);
    RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
    rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, input.corners.data(), 0, 12,
                               size_t(3) * input.triangle_count);
    rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, input.indices.data(), 0, 12,
                               input.triangle_count);
    double start = milliseconds();
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene, geometry);
    rtcReleaseGeometry(geometry);
    rtcCommitScene(scene);
    build_ms = milliseconds() - start;
    return scene;
}

static void answer(RTCScene scene, const Input& input, std::vector<uint32_t>& answers, size_t begin, size_t end) {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
    for (size_t i = begin; i < end; i++) {
        const float* r = &input.rays[6 * i];
        RTCRayHit hit;
        hit.ray.org_x = r[0], hit.ray.org_y = r[1], hit.ray.org_z = r[2];
        hit.ray.dir_x = r[3], hit.ray.dir_y = r[4], hit.ray.dir_z = r[5];
        hit.ray.tnear = 0, hit.ray.tfar = std::numeric_limits<float>::infinity();
        hit.ray.time = 0, hit.ray.mask = ~0u, hit.ray.id = 0, hit.ray.flags = 0;
        hit.hit.geomID = hit.hit.instID[0] = hit.hit.primID = RTC_INVALID_GEOMETRY_ID;
        rtcIntersect1(scene, &context, &hit);
        answers[i] = hit.hit.geomID == RTC_INVALID_GEOMETRY_ID ? ~0u : hit.hit.primID;
    }
}

static double trace(RTCScene scene, const Input& input, std::vector<uint32_t>& answers, unsigned threads) {
    const size_t run = 4096;
    double start = milliseconds();
    if (threads == 1) {
        answer(scene, input, answers, 0, input.ray_count);
    } else {
        std::atomic<size_t> next{0};
        std::vector<std::thread> workers;
        for (unsigned t = 0; t < threads; t++) {
            workers.emplace_back([&] {
                for (size_t i; (i = next.fetch_add(run)) < input.ray_count;)
                    answer(scene, input, answers, i, std::min<size_t>(i + run, input.ray_count));
            });
        }
        for (auto& worker : workers) worker.join();
    }
    return milliseconds() - start;
}

static void print(const char* name, std::vector<double> times, const char* end) {
    std::sort(times.begin(), times.end());
    std::printf("\"%s\": [", name);
    for (size_t i = 0; i < times.size(); i++) std::printf("%s%.3f", i ? ", " : "", times[i]);
    std::printf("]%s", end);
}

int main(int count, char** arguments) {
    if (count != 5) fail("usage: harness RAYS ANSWERS THREADS ROUNDS");
    Input input = read(arguments[1]);
    unsigned threads = unsigned(std::max(1, std::atoi(arguments[3])));
    int rounds = std::max(1, std::atoi(arguments[4]));
    RTCDevice device = rtcNewDevice(("threads=" + std::to_string(threads)).c_str());
    if (!device) fail("no device");
    std::vector<uint32_t> answers(input.ray_count);
    std::vector<double> builds, traces;
    // One round of warm-up.
    for (int round = -1; round < rounds; round++) {
        double build_ms = 0;
        RTCScene scene = build(device, input, build_ms);
        double trace_ms = trace(scene, input, answers, threads);
        rtcReleaseScene(scene);
        if (round >= 0) builds.push_back(build_ms), traces.push_back(trace_ms);
    }
    rtcReleaseDevice(device);
    FILE* file = std::fopen(arguments[2], "wb");
    if (!file || std::fwrite(answers.data(), 4, answers.size(), file) != answers.size()) fail("cannot write the answers");
    std::fclose(file);
    std::printf("{");
    print("build_ms", builds, ", ");
    print("rays_ms", traces, "}\n");
}
