// A pass that does nothing, and takes no time to compile.
#version 460

void main() {}
