#include "tools/command.h"

#include <malloc.h>

int main(int argc, char** argv) {
    using namespace sahel::tools;
#ifdef __GLIBC__
    // Tiles of some megabytes are made on many threads and freed on one: kept in the heaps of those threads they would
    // hold 600 MiB that nobody uses. From this size on memory goes back to the system at once, at no measured cost.
    mallopt(M_MMAP_THRESHOLD, 1 << 20);
#endif
    CommandLine line;
    add_new_command(line);
    add_import_command(line);
    add_simulate_command(line);
    add_fly_command(line);
    add_demo_command(line);
    add_inspect_commands(line);
    add_scene_command(line);
    add_experiment_command(line);
    add_bench_command(line);
    add_doctor_command(line);
    return line.run(argc, argv);
}
