#version 460

layout(location = 0) flat in uint triangle;
layout(location = 0) out uint seen;

void main() { seen = triangle; }
