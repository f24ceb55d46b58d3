#!/usr/bin/env python3
# linear.py - a linear model of flexbeam, as JSON, in a form that others read: python3 linear.py MODEL.json FILE...
# FILE.mat: for MATLAB and Octave, FILE.npz: for NumPy. Both have A, B, C, D; states, inputs, outputs and steady_state: names,
# each with ..._units, and steady_state_values; model, crc, flexbeam, precision, error. Wants NumPy and SciPy.
# A family of `flexbeam scene FILE --linear family.json --grid NAME FROM TO N`: A, B, C, D, steady_state_values and error have an
# axis for each parameter before their own; parameters: names, grid_NAME: values.
# As a module: linear.read('model.json')['A'].
import json
import sys

try:
    import numpy as np
    from scipy import io
except ImportError as missing:
    sys.exit('linear.py: %s: python3 -m pip install numpy scipy' % missing)


def one_model(text):
    """Of one linear model: matrices, arrays of names, of units."""
    model = {key: text[key] for key in ('model', 'crc', 'flexbeam', 'precision', 'error')}
    for key in ('states', 'inputs', 'outputs', 'steady_state'):
        model[key] = [item['name'] for item in text[key]]
        model[key + '_units'] = [item['unit'] for item in text[key]]
    model['steady_state_values'] = np.array([item['value'] for item in text['steady_state']], dtype=float)
    n, n_in, n_out = (len(text[key]) for key in ('states', 'inputs', 'outputs'))
    for key, shape in ('A', (n, n)), ('B', (n, n_in)), ('C', (n_out, n)), ('D', (n_out, n_in)):
        model[key] = np.array(text[key], dtype=float).reshape(shape)
    return model


def family(path, text):
    """Of models over a grid: arrays with an axis for each parameter, names of the first."""
    models = [one_model(model) for model in text['models']]
    shape = [len(item['values']) for item in text['parameters']]
    all_of = dict(models[0], parameters=[item['name'] for item in text['parameters']])
    all_of['crc'] = [model['crc'] for model in models]
    for key in ('states', 'inputs', 'outputs'):
        if any(model[key] != all_of[key] for model in models):
            raise ValueError('%s: the models have other %s' % (path, key))
    for key in ('A', 'B', 'C', 'D', 'steady_state_values', 'error'):
        all_of[key] = np.array([model[key] for model in models]).reshape(shape + list(np.shape(models[0][key])))
    for item in text['parameters']:
        all_of['grid_' + item['name']] = np.array(item['values'], dtype=float)
    return all_of


def read(path):
    """What the JSON file says: a model, or a family of them."""
    with open(path, encoding='utf-8') as file:
        text = json.load(file)
    if text.get('format') == 'flexbeam linear family 1':
        return family(path, text)
    if text.get('format') != 'flexbeam linear model 1':
        raise ValueError(path + ': no linear model of flexbeam, or one of another version')
    return one_model(text)


def write(model, path):
    """To .mat, names as cells, or to .npz, names as arrays of text."""
    names = {key: value for key, value in model.items() if isinstance(value, list)}
    if path.endswith('.mat'):
        cells = {key: np.array(value, dtype=object).reshape(-1, 1) for key, value in names.items()}
        io.savemat(path, {**model, **cells}, oned_as='column')
    elif path.endswith('.npz'):
        np.savez(path, **{**model, **{key: np.array(value, dtype=str) for key, value in names.items()}})
    else:
        raise ValueError(path + ': wants .mat or .npz at its end')


def main(arguments):
    if len(arguments) < 2 or arguments[0].startswith('-'):
        print('usage: linear.py MODEL.json FILE.mat|FILE.npz ...', file=sys.stderr)
        return 2
    try:
        model = read(arguments[0])
        for path in arguments[1:]:
            write(model, path)
    except (OSError, ValueError, KeyError) as error:
        print('linear.py:', error, file=sys.stderr)
        return 1
    return 0


if __name__ == '__main__':
    sys.exit(main(sys.argv[1:]))
