#include "tools/command.h"

int main(int argc, char** argv) {
    using namespace sahel::tools;
    CommandLine line;
    add_new_command(line);
    add_import_command(line);
    add_fly_command(line);
    add_demo_command(line);
    add_inspect_commands(line);
    add_bench_command(line);
    add_doctor_command(line);
    return line.run(argc, argv);
}
