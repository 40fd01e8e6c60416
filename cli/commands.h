// The subcommands; each takes its own argc and argv, argv[0] being its name, and returns the program's exit code.
#ifndef OCTALUX_CLI_COMMANDS_H
#define OCTALUX_CLI_COMMANDS_H

int command_scene(int argc, char **argv);
int command_place(int argc, char **argv);
int command_bake(int argc, char **argv);
int command_join(int argc, char **argv);
int command_render(int argc, char **argv);
int command_compare(int argc, char **argv);
int command_audit(int argc, char **argv);
int command_info(int argc, char **argv);
int command_verify(int argc, char **argv);
int command_pack(int argc, char **argv);
int command_unpack(int argc, char **argv);
int command_export(int argc, char **argv);
int command_export_ktx2(int argc, char **argv);
int command_export_web(int argc, char **argv);
int command_view(int argc, char **argv);

#endif
