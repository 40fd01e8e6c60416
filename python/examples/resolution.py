"""Figure 18 of McGuire et al. 2017 in ten lines: the error of light as maps grow, on top of the noise of both pictures. It goes to
resolution.png: with matplotlib as a plot, else as bare curves, diffuse light in orange, glossy light in blue, logarithms on both axes."""
import numpy as np
import octalux


def draw(errors):
    try:
        import matplotlib.pyplot as plot
        plot.loglog(list(errors), list(errors.values()), "o-", label=LAYERS)
        plot.xlabel("texels along a map"), plot.ylabel("relative MSE"), plot.legend(), plot.savefig("resolution.png")
    except ImportError:
        paper, sizes, values = np.full((240, 320, 3), 0.9), np.log(list(errors)), np.log(list(errors.values()))
        across = np.interp(np.arange(20, 300), np.interp(sizes, (sizes[0], sizes[-1]), (20, 300)), np.arange(len(sizes)))
        for column, color in enumerate(((0.8, 0.3, 0.0), (0.0, 0.2, 0.8))):
            heights = np.interp(across, np.arange(len(sizes)), values[:, column])
            rows = np.interp(heights, (values.min(), values.max()), (220, 20)).astype(int)
            for thickness in range(3):
                paper[rows + thickness, np.arange(20, 300)] = color
        octalux.Image({"beauty": paper}).save("resolution.png")


LAYERS = ("indirect_diffuse", "indirect_glossy")
scene, errors = octalux.Scene("builtin:cornell-glossy"), {}
truth = octalux.render(scene, width=96, height=96, spp=1024)
for size in (16, 32, 64, 128, 256):
    octalux.bake(scene, "resolution.olx", radiance_size=size)
    with octalux.open("resolution.olx") as field:
        picture = octalux.render(scene, field, width=96, height=96, spp=16)
    errors[size] = [octalux.compare(picture, truth, layer).relative_mse for layer in LAYERS]
    print(f"{size:4d} texels: relative MSE of diffuse light {errors[size][0]:.4f}, of glossy light {errors[size][1]:.4f}")
draw(errors)
