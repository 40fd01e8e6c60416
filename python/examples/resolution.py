"""Figure 18 of McGuire et al. 2017: the error of light as maps grow, on top of the noise of both pictures. resolution.py [SCENE] writes resolution.png where matplotlib is."""
import sys, tempfile
import octalux

scene, errors = octalux.Scene(sys.argv[1] if len(sys.argv) > 1 else "builtin:cornell-glossy"), {}
truth = octalux.render(scene, width=96, height=96, spp=1024)
with tempfile.TemporaryDirectory() as folder:
    for size in (16, 32, 64, 128, 256):
        octalux.bake(scene, f"{folder}/field.olx", radiance_size=size)
        with octalux.open(f"{folder}/field.olx") as field:
            picture = octalux.render(scene, field, width=96, height=96, spp=16)
        errors[size] = [octalux.compare(picture, truth, layer).relative_mse for layer in ("indirect_diffuse", "indirect_glossy")]
        print(f"{size:4d} texels: relative MSE of diffuse light {errors[size][0]:.4f}, of glossy light {errors[size][1]:.4f}")
try:
    import matplotlib.pyplot as plot
    plot.loglog(list(errors), list(errors.values()), "o-", label=["diffuse", "glossy"])
    plot.xlabel("texels along a map"), plot.ylabel("relative MSE"), plot.legend(), plot.savefig("resolution.png")
except ImportError:
    print("No picture is drawn: matplotlib is not installed.")
